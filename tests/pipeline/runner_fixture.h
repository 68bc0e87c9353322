// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over a folder with an in-memory store, which report what they computed.
#pragma once

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/results/tables.h"
#include "pipeline/rules/rules.h"
#include "stages/scan/scan.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {

// Number of jobs of a first run over `meshes` with ground truth and their scans, counted in the table of
// rules: a new model or stage changes no number in a test.
class JobCounts {
 public:
  JobCounts(const Config& config, std::size_t meshes) : rules_(make_rules(config)), meshes_(meshes) {}
  explicit JobCounts(const std::string& yaml = kToyConfig, std::size_t meshes = 2)
      : JobCounts(toy_config(yaml), meshes) {}

  std::size_t shapes() const { return meshes_ + (has_scans() ? meshes_ * kViews : 0); }

  template <class Predicate>  // `is`: predicate of a Rule
  std::size_t where(const Predicate& wanted) const {
    std::size_t sum = 0;
    for (const Rule& rule : rules_)
      if (wanted(rule)) sum += jobs_of(rule);
    return sum;
  }

  std::size_t of_shapes() const {
    return where([](const Rule& rule) { return !rule.gathers; });
  }
  std::size_t all() const {
    return where([](const Rule&) { return true; });
  }

  // Jobs of one stage. A name without a rule is an error in the test.
  std::size_t of(std::string_view name) const {
    return expect_some(where([&](const Rule& rule) { return rule.stage == name; }), name);
  }

  // Map, matched map, scores, score table and mean histogram, as far as the model has them.
  std::size_t of_model(std::string_view model) const {
    return expect_some(
        where([end = "." + std::string(model)](const Rule& rule) { return rule.stage.ends_with(end); }),
        model);
  }

  // Jobs of one artefact layout, such as "scores", which gives the rows of results.csv.
  std::size_t of_kind(std::string_view kind) const {
    return expect_some(where([&](const Rule& rule) { return rule.kind == kind; }), kind);
  }

 private:
  bool has_scans() const {
    return std::ranges::any_of(rules_, [](const Rule& rule) { return rule.level() == kScans; });
  }
  std::size_t jobs_of(const Rule& rule) const {
    if (rule.gathers) return 1;
    return rule.over == kMeshes ? meshes_ : meshes_ * kViews;
  }
  static std::size_t expect_some(std::size_t count, std::string_view name) {
    if (count == 0) throw std::out_of_range("no job of " + std::string(name));
    return count;
  }

  Rules rules_;
  std::size_t meshes_;
};

class Runs : public testing::Test {
 protected:
  // Runs, keeps the run, and returns "stage@item" of everything computed.
  std::vector<std::string> run(Config config, int threads = 2) {
    toy_.reset();
    toy_ = std::make_unique<ToyRun>(data_.path(), store_, std::move(config));
    toy_->run(threads);
    return store_.take_saved();
  }
  std::vector<std::string> run(const std::string& yaml = kToyConfig, int threads = 2) {
    return run(toy_config(yaml), threads);
  }

  // Causes of the last run.
  std::vector<std::string> failures() const {
    std::vector<std::string> causes;
    for (const Failure& failure : toy_->resolver->failures()) causes.push_back(failure.cause);
    return causes;
  }
  std::vector<Metric> metrics() const { return chosen_metrics(toy_->config.metrics); }
  std::string results() const { return to_csv(results_table(toy_->results(), metrics())); }
  GroundTruth truth(std::size_t item = 0) const {
    return toy_->value<GroundTruth>("ground_truth", mesh_unit(item));
  }

  const TemporaryFolder data_;
  MemoryStore store_;
  std::unique_ptr<ToyRun> toy_;
};

class RunnerTest : public Runs {
 protected:
  RunnerTest() { write_two_toy_items(data_.path()); }

  const JobCounts jobs_;  // counts of a first run over both meshes
};

}  // namespace salbench
