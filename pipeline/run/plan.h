// SPDX-License-Identifier: GPL-3.0-or-later
// Plans a run without computing or writing anything: jobs per stage, jobs of one item, and the flow graph
// with its strata.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/engine/rule.h"
#include "pipeline/results/counts.h"
#include "pipeline/run/session.h"

namespace salbench {

struct StagePlan {
  StageCount count;
  std::size_t artefacts = 0;  // artefacts of the stage in the cache, for any configuration
  std::uint64_t bytes = 0;
};

// A setup with its plan.
struct PlannedRun {
  explicit PlannedRun(const Request& request, const Front& front = {});

  std::size_t open() const;  // jobs to compute or waiting

  Setup setup;
  FolderStore store;
  Plan plan;
  std::vector<StagePlan> stages;  // stages of the configuration, then those only in the cache
  std::size_t own_stages = 0;     // number of stages of the configuration
};

// Artefact of the same stage and item, with the lines in which its recipe differs from the planned one.
struct OtherRecipe {
  std::filesystem::path file;
  std::string key;
  std::vector<std::string> before, now;
};
struct StageOfItem {
  std::string stage, state, why;
};
struct ItemPlan {
  std::vector<StageOfItem> stages;
  // Set if a single stage was requested and its key is known.
  std::string key = {};
  std::vector<OtherRecipe> others = {};
};
// item: a mesh or point cloud (52), or a scan (52_3). stage: empty for all. Throws ConfigError if either does
// not exist.
ItemPlan plan_of_item(const Request& request, const Front& front, const std::string& item,
                      const std::string& stage);

struct GraphNode {
  std::string name, stage;       // "fpfh of scans", "fpfh"
  std::string_view shapes, per;  // "scans", "scan"
  std::int32_t version = 0;
  std::vector<std::string> options = {};  // "radius: 0.02"
  std::vector<std::string> inputs = {};   // names of all input nodes
  std::vector<std::string> cuts = {};     // inputs from earlier strata, read back from the cache
  std::size_t stratum = 0;                // executed in ascending order
  std::optional<std::size_t> to_do = {};  // open jobs; nullopt without a data set
};
using Graph = std::vector<GraphNode>;  // in the order of the rules

Graph graph_of(const Rules& rules);
// Graph of a request. Without a data set, the graph of the rules alone.
Graph graph_of_run(const Request& request, const Front& front = {});

}  // namespace salbench
