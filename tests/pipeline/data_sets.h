// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over data sets in a temporary folder, for tests of layouts and user data sets.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "stages/metrics/score.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {

class DataSets : public testing::Test {
 protected:
  // Runs over a layout; keeps the items, or the error message.
  void run(const std::string& layout, const std::string& more = "scans: false") {
    toy_.reset();
    toy_ = std::make_unique<ToyRun>(
        data_.path(), store_,
        fmt::format("dataset: {{layout: {}, {}}}\nscan: {{step_degrees: 2}}\nmodels: {{RS: , HS: }}\n",
                    layout, more));
    toy_->run();
  }
  GroundTruth truth(std::size_t item = 0) const {
    return value_as<GroundTruth>(*toy_->resolver->value({toy_->index("ground_truth"), mesh_unit(item)}));
  }
  std::vector<std::string> failures() const {
    std::vector<std::string> causes;
    for (const Failure& failure : toy_->resolver->failures()) causes.push_back(failure.cause);
    return causes;
  }
  // Score of a model on the first mesh or scan in the table; NaN if the metric is undefined.
  double score_of(std::string_view model, std::string_view metric, bool scan = false) const {
    for (const ResultRow& row : toy_->results())
      if (row.model == model && !row.view.empty() == scan) return value_of(row.scores, metric);
    ADD_FAILURE() << "no scores of " << model;
    return 0;
  }
  std::string place(const std::string& name) const { return (data_ / name).string(); }
  std::vector<std::string> units() const {
    std::vector<std::string> names;
    for (const Family& family : toy_->inputs.units.families()) names.push_back(family.name);
    return names;
  }
  // Writes own.py, replacing the previous version.
  std::string data_set(const std::string& python) {
    return folder_.write("own.py", "from salbench.datasets import *\n" + python).string();
  }

  TemporaryFolder data_, folder_;
  MemoryStore store_;
  std::unique_ptr<ToyRun> toy_;
};

}  // namespace salbench
