// SPDX-License-Identifier: GPL-3.0-or-later
// Job counts per stage, all levels together, for `salbench plan` and the record of a run.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/engine/plan.h"

namespace salbench {

struct StageCount {
  std::string stage;
  std::int32_t version = 0;
  std::size_t cached = 0, compute = 0, wait = 0, not_applicable = 0, failed = 0;
  std::vector<std::pair<std::string, std::size_t>> reasons;  // most frequent first
};

// Words for the reason of one job, the same for all that are to be counted together; empty: not counted.
using Why = std::function<std::string(const Job& job)>;
std::vector<StageCount> count_by_stage(const Project& project, const Plan& plan, const Why& why = {});

}  // namespace salbench
