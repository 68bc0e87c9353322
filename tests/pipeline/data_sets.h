// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over layouts and user data sets.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "stages/metrics/score.h"
#include "tests/pipeline/runner_fixture.h"

namespace salbench {

class DataSets : public Runs {
 protected:
  std::vector<std::string> run(const std::string& layout, const std::string& more = "scans: false") {
    return Runs::run(fmt::format(
        "dataset: {{layout: {}, {}}}\nscan: {{step_degrees: 2}}\nmodels: {{RS: , HS: }}\n", layout, more));
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

  const TemporaryFolder folder_;
};

}  // namespace salbench
