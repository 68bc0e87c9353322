// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/density_value.h"

#include <algorithm>
#include <utility>

#include "io/hdf5/value_arrays.h"

namespace salbench {

Arrays ArrayForm<DensityCounts>::arrays(const DensityCounts& counts) {
  return {scalar("fold", counts.fold, "1", "part of the set that the shape belongs to"),
          column("cells", counts.cells, "1", "(blur * 76 + value bin) * 18 + distance bin, ascending"),
          column("points", counts.points, "1", "share of the points in each cell"),
          column("marked", counts.marked, "1", "share of the ground truth in each cell")};
}
DensityCounts ArrayForm<DensityCounts>::read(const Arrays& arrays) {
  DensityCounts counts{scalar_of<std::int32_t>(arrays, "fold"), values_of<std::int32_t>(arrays, "cells"),
                       values_of<float>(arrays, "points"), values_of<float>(arrays, "marked")};
  const auto cells = counts.cells.size();
  if (counts.points.size() != cells || counts.marked.size() != cells ||
      !std::ranges::is_sorted(counts.cells) || (cells > 0 && counts.cells[0] < 0))
    throw InputError("the data sets 'cells', 'points' and 'marked' do not fit each other");
  return counts;
}

// One row per fold.
Arrays ArrayForm<DensityFits>::arrays(const DensityFits& fits) {
  std::vector<std::int64_t> shapes;
  std::vector<double> blur, gain, value, distance;
  for (const DensityFit& fit : fits) {
    shapes.push_back(fit.shapes);
    blur.push_back(fit.blur);
    gain.push_back(fit.gain);
    value.insert(value.end(), fit.value.begin(), fit.value.end());
    distance.insert(distance.end(), fit.distance.begin(), fit.distance.end());
  }
  return {column("shapes", std::move(shapes), "1", "of the other folds, which each was fitted to; 0: none"),
          column("blur", std::move(blur), "R", "standard deviation of the blur along the surface"),
          column("gain", std::move(gain), "bits", "information gain over the uniform map on these shapes"),
          {"value",
           {fits.size(), kValueKnots},
           std::move(value),
           "1",
           "logarithm of the density at values 0, 1/19, ..., 1 of the map"},
          {"distance",
           {fits.size(), kDistanceKnots},
           std::move(distance),
           "1",
           "added to it at distances 0, 1/9, ..., 1 R from the centroid"}};
}
DensityFits ArrayForm<DensityFits>::read(const Arrays& arrays) {
  const auto& shapes = values_of<std::int64_t>(arrays, "shapes");
  const auto& blur = values_of<double>(arrays, "blur");
  const auto& gain = values_of<double>(arrays, "gain");
  const auto& value = values_of<double>(arrays, "value");
  const auto& distance = values_of<double>(arrays, "distance");
  const std::size_t n = shapes.size();
  if (blur.size() != n || gain.size() != n || value.size() != n * kValueKnots ||
      distance.size() != n * kDistanceKnots)
    throw InputError("the data sets of the fits have other sizes");
  DensityFits fits(n);
  for (std::size_t fold = 0; fold < n; ++fold) {
    fits[fold] = {.shapes = shapes[fold], .blur = blur[fold], .gain = gain[fold]};
    std::copy_n(value.data() + fold * kValueKnots, kValueKnots, fits[fold].value.begin());
    std::copy_n(distance.data() + fold * kDistanceKnots, kDistanceKnots, fits[fold].distance.begin());
  }
  return fits;
}

}  // namespace salbench
