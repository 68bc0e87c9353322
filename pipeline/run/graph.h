// SPDX-License-Identifier: GPL-3.0-or-later
// The flow graph: a node per row of the catalog, an edge per input. Tickets for meshes, scans, point clouds
// and the data set stream along the edges, and a node settles a job when the last open input of it has
// arrived.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

#include "pipeline/plan/plan.h"

namespace salbench {

// Bodies of the nodes; they know no TBB. Called from several threads at once, for different jobs.
struct GraphBodies {
  // True if a job is to be settled in this stream. Asked once for each, before the first is.
  std::function<bool(const JobRef&)> open = {};
  // A family has a token and may begin. False: it cannot now, and its jobs stay open.
  std::function<bool(std::size_t family)> enter = {};
  // Everything that the job reads is settled. False: it cannot be settled now (sets only).
  std::function<bool(const JobRef&)> settle = {};
  // The last job of a family is settled, or the stream has ended early; once per family that entered.
  std::function<void(std::size_t family)> leave = {};
};

struct GraphLimits {
  int threads = 1;
  int families = 2;  // entered and not left: what bounds the memory
};

// Returns when every job that could be settled is; once `stop` is set, when the jobs at work are. If a body
// throws, the rest is abandoned and the first exception is thrown again here.
void stream(const Context& context, const GraphLimits& limits, const std::atomic<bool>& stop,
            const GraphBodies& bodies);

// The edges of the graph: one for each input of each row.
struct Edge {
  std::size_t from = 0, to = 0;  // rows
  bool operator==(const Edge&) const = default;
};
std::vector<Edge> edges(const Catalog& catalog);

}  // namespace salbench
