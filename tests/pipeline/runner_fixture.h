// SPDX-License-Identifier: GPL-3.0-or-later
// Two meshes, an in-memory store, and runs over them that report what they computed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/results/tables.h"
#include "tests/support/job_counts.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {

// Called before the stage's own function.
using Before = std::function<void(const JobInputs&)>;
inline void do_before(Rule& rule, const Before& before) {
  rule.compute = [before, was = rule.compute](const JobInputs& in) {
    before(in);
    return was(in);
  };
}

class RunnerTest : public testing::Test {
 protected:
  void SetUp() override { write_two_toy_items(data_.path()); }

  // Runs and returns "stage@item" of everything computed.
  std::vector<std::string> run(const std::string& yaml = kToyConfig, int threads = 2) {
    ToyRun toy(data_.path(), store_, yaml);
    toy.run(threads);
    for (const Failure& failure : toy.resolver->failures())
      failures_.push_back(toy.project.name(failure.job) + ": " + toy.project.rule(failure.job).stage + ": " +
                          failure.cause);
    results_ = to_csv(results_table(toy.results(), chosen_metrics(toy.config.metrics)));
    return store_.take_saved();
  }

  const JobCounts jobs_;  // counts of a first run over both meshes
  TemporaryFolder data_;
  MemoryStore store_;
  std::vector<std::string> failures_;
  std::string results_;
};

}  // namespace salbench
