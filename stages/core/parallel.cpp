// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/parallel.h"

#include <algorithm>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "stages/core/check.h"

namespace salbench {

void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body) {
  CHECK_LT(0U, grain);
  if (n == 0) return;
  if (n <= grain) return body(0, n);
  const std::size_t ranges = (n - 1) / grain + 1;
  // Bound to the context around it, the loop would end half done when that is cancelled, and the result would
  // be stored as a whole one.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, ranges, 1),
        [&](const tbb::blocked_range<std::size_t>& some) {
          for (std::size_t range = some.begin(); range < some.end(); ++range)
            body(range * grain, std::min((range + 1) * grain, n));
        },
        context);
  });
}

}  // namespace salbench
