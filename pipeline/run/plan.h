// SPDX-License-Identifier: GPL-3.0-or-later
// Plans a run without computing or writing anything: jobs by stage, jobs of one item, and the flow graph with
// its cuts.
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
  std::size_t artefacts = 0;  // that the cache has of the stage, whoever needs them
  std::uint64_t bytes = 0;
};

// A setup with its plan.
struct PlannedRun {
  explicit PlannedRun(const Request& request, const Front& front = {});

  std::size_t open() const;  // jobs to compute, or waiting

  Setup setup;
  FolderStore store;
  Plan plan;
  std::vector<StagePlan> stages;  // of the configuration, and then those that the cache alone has
  std::size_t own_stages = 0;     // so many are of the configuration
};

// An artefact of the same stage and item, and lines in which its recipe differs from the one that is planned.
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
  // Set if one stage was asked for and its key is known.
  std::string key = {};
  std::vector<OtherRecipe> others = {};
};
// item: a mesh or point cloud (52), or a scan (52_3). stage: empty for all. Throws ConfigError if there is no
// such item or stage.
ItemPlan plan_of_item(const Request& request, const Front& front, const std::string& item,
                      const std::string& stage);

struct GraphNode {
  std::string name, stage;       // "fpfh of scans", "fpfh"
  std::string_view shapes, per;  // "scans", "scan"
  std::int32_t version = 0;
  std::vector<std::string> options = {};  // "radius: 0.02"
  std::vector<std::string> inputs = {};   // names of nodes, all of them
  std::vector<std::string> cuts = {};     // of these, inputs of earlier strata: read back from the cache
  std::size_t stratum = 0;                // streamed one after the other
  std::optional<std::size_t> to_do = {};  // open jobs; nothing if no data set was looked at
};
using Graph = std::vector<GraphNode>;  // in the order of the rules

Graph graph_of(const Rules& rules);
// Graph of a request. If it names no data set, nor anything about one, the graph is that of the rules alone.
Graph graph_of_run(const Request& request, const Front& front = {});

}  // namespace salbench
