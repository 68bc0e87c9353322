// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/interpolated.h"

#include <algorithm>
#include <cstdint>

namespace salbench {

void fill_from_nearest(Points points, ScalarField& values) {
  std::vector<std::int32_t> known;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isnan(values[i])) known.push_back(static_cast<std::int32_t>(i));
  if (known.size() == values.size()) return;
  if (known.empty()) return std::fill(values.begin(), values.end(), 0.0);
  const KdTree tree(points, std::move(known));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isnan(values[i])) values[i] = values[static_cast<std::size_t>(tree.nearest(points[i]))];
}

}  // namespace salbench
