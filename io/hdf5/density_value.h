// SPDX-License-Identifier: GPL-3.0-or-later
// The layouts of fitted densities and of the counts that they are fitted to (docs/data_dictionary.md).
#pragma once

#include <string_view>

#include "io/arrays.h"
#include "stages/core/fitted.h"

namespace salbench {

// `read` throws InputError as those of io/hdf5/value.h.
template <>
struct ArrayForm<DensityCounts> {
  static constexpr std::string_view kind = "density_counts";
  static Arrays arrays(const DensityCounts& counts);
  static DensityCounts read(const Arrays& arrays);
};

template <>
struct ArrayForm<DensityFits> {
  static constexpr std::string_view kind = "density_fits";
  static Arrays arrays(const DensityFits& fits);
  static DensityFits read(const Arrays& arrays);
};

}  // namespace salbench
