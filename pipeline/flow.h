// Streams families of work (a mesh and its scans) over all threads with bounded memory. Knows no stage.
#pragma once

#include <atomic>
#include <functional>

namespace salbench {

struct FlowBodies {
  std::function<int(int family)> open;  // prepares what the parts share; returns how many parts there are
  std::function<void(int family, int part)> part;  // parts of one family run in parallel, in any order
  std::function<void(int family)> close;           // after all parts; one family at a time
};

struct FlowLimits {
  int threads = 1;
  int families_alive = 2;  // opened and not yet closed: what bounds the memory
};

// Returns when every family is closed, or, once `stop` is set, when those already open are. If a body throws,
// the rest is abandoned and the first exception is thrown again here.
void stream_families(int families, const FlowLimits& limits, const std::atomic<bool>& stop,
                     const FlowBodies& bodies);

}  // namespace salbench
