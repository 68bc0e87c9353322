// SPDX-License-Identifier: GPL-3.0-or-later
// Sizes of the shapes of a data set: one that is much larger or smaller than the others is in another unit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/dataset.h"
#include "stages/core/types.h"

namespace salbench {

double diagonal_of(Points points);  // of the bounding box of the finite points; 0 of none

// For each diagonal a line that says how far it is from the median, where that is more than a factor of 100;
// else empty. A diagonal that is 0 is not known.
std::vector<std::string> odd_sizes(std::span<const double> diagonals);

// Reads the shapes, and gives those that are in another unit than most a problem, where they have none. A
// file that cannot be read fails by itself.
void fail_mixed_units(Dataset& dataset);

}  // namespace salbench
