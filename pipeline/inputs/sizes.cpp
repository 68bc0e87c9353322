// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/sizes.h"

#include <map>

#include <fmt/format.h>

#include "io/cloud_file.h"
#include "io/file.h"
#include "io/mesh_file.h"
#include "pipeline/inputs/given_truth.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"
#include "stages/core/quantile.h"

namespace salbench {
namespace {

constexpr double kMost = 100;  // between a diagonal and the median: shapes of one unit are nearer

double diagonal_in_file(const DatasetItem& item) try {
  const std::string bytes = read_file(item.mesh);
  if (has_columns(item))
    return diagonal_of(parse_column_cloud(bytes, item.mesh, item.format->columns).points);
  return is_point_cloud(bytes, item.mesh) ? diagonal_of(parse_cloud(bytes, item.mesh).points)
                                          : diagonal_of(parse_mesh(bytes, item.mesh).vertices);
} catch (const InputError&) {
  return 0;
}

// Views share the file of their shape, which is read once.
std::vector<double> diagonals_of(const std::vector<DatasetItem>& items) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < items.size(); ++i) first.emplace(items[i].mesh, i);
  std::vector<double> diagonals(items.size());
  parallel_ranges(items.size(), 1, [&](std::size_t i, std::size_t) {
    if (first.at(items[i].mesh) == i) diagonals[i] = diagonal_in_file(items[i]);
  });
  for (std::size_t i = 0; i < items.size(); ++i) diagonals[i] = diagonals[first.at(items[i].mesh)];
  return diagonals;
}

}  // namespace

double diagonal_of(Points points) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(kNone), high = -low;
  for (const Vec3& point : points) {
    if (!point.allFinite()) continue;
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return low.x() <= high.x() ? (high - low).norm() : 0;
}

std::vector<std::string> odd_sizes(std::span<const double> diagonals) {
  std::vector<double> known;
  for (const double diagonal : diagonals)
    if (diagonal > 0) known.push_back(diagonal);
  const double usual = median(known);
  std::vector<std::string> lines;
  for (const double diagonal : diagonals) {
    const bool odd = diagonal > 0 && (diagonal > usual * kMost || diagonal < usual / kMost);
    lines.push_back(
        odd ? fmt::format("its diagonal, {:.4g}, is {:.3g} times the median of the data set, {:.4g}",
                          diagonal, diagonal / usual, usual)
            : "");
  }
  return lines;
}

void fail_mixed_units(Dataset& dataset) {
  const std::vector<std::string> odd = odd_sizes(diagonals_of(dataset.items));
  for (std::size_t i = 0; i < odd.size(); ++i) {
    DatasetItem& item = dataset.items[i];
    if (!odd[i].empty() && item.problem.empty())
      item.problem =
          fmt::format("{}: {}: it is in another unit than {} says: scale it, or take it out of the set",
                      item.mesh, odd[i], dataset.unit.where);
  }
}

}  // namespace salbench
