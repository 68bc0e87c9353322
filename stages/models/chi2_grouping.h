// SPDX-License-Identifier: GPL-3.0-or-later
// The order of histograms that makes the chi-square search pass over most of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// n indices: the histograms in an order in which each group of 16 in a row resemble each other, as do groups
// beside each other. Looks only at these bins. Does not depend on the number of threads.
std::vector<std::int32_t> grouped_by_likeness(const Descriptors& descriptors,
                                              std::span<const std::size_t> bins);

}  // namespace salbench
