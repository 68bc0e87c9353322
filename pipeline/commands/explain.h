// SPDX-License-Identifier: GPL-3.0-or-later
// Why a job is not simply a hit, in words.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/engine/causes.h"
#include "pipeline/results/counts.h"

namespace salbench {

struct Explanation {
  std::string stage;
  std::string state;           // "cached", "to compute", "waiting", "damaged" ...
  std::string why;             // one line, as "fpfh.radius 0.02 -> 0.03", "mesh file 52.off changed"
  std::filesystem::path file;  // the artefact, or the nearest; empty if there is none
};

// Explains one stage of an item such as "52" or "52_3"; all of them, in the order of the rules, if none is
// named. Throws ConfigError for an item or a stage that does not exist.
std::vector<Explanation> explain(const Project& project, const Index& index,
                                 const std::filesystem::path& cache, const std::string& item,
                                 const std::string& stage);

// The same words for every job with the same cause, to be counted; `causes` must outlive it.
Why why_open(Causes& causes);
Why why_computed(Causes& causes);  // after a run: nothing for jobs that it found or left

}  // namespace salbench
