// SPDX-License-Identifier: GPL-3.0-or-later
// Number of jobs of a first run, counted in the table of rules: a new model or stage changes no number in a
// test.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/rules/rules.h"
#include "stages/scan/scan.h"
#include "tests/support/toy_data.h"

namespace salbench {

// For `meshes` with ground truth, and their scans.
class JobCounts {
 public:
  JobCounts(const Config& config, std::size_t meshes) : rules_(make_rules(config)), meshes_(meshes) {}
  explicit JobCounts(const std::string& yaml = kToyConfig, std::size_t meshes = 2)
      : JobCounts(toy_config(yaml), meshes) {}

  std::size_t meshes() const { return meshes_; }
  std::size_t scans() const { return has_scans() ? meshes_ * kViews : 0; }
  std::size_t shapes() const { return meshes() + scans(); }

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
  std::size_t of_the_data_set() const { return all() - of_shapes(); }
  std::size_t all() const {
    return where([](const Rule&) { return true; });
  }

  // Number of jobs that need nothing from the rest of the data set: no means, and no readers of means.
  std::size_t before_reference() const {
    std::vector<bool> after(rules_.size(), false);
    std::size_t sum = 0;
    for (std::size_t r = 0; r < rules_.size(); ++r) {
      const Rule& rule = rules_[r];
      after[r] = rule.gathers;
      for (const std::size_t input : rule.inputs) after[r] = after[r] || after[input];
      if (!after[r]) sum += jobs_of(rule);
    }
    return sum;
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

}  // namespace salbench
