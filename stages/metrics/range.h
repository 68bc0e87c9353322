// SPDX-License-Identifier: GPL-3.0-or-later
// Values that a metric can take at all, by its name: intervals of its mean need not go beyond them.
#pragma once

#include <string_view>

#include "stages/core/options.h"

namespace salbench {

// Of a metric of metric_table(), its twins by area and with multiplicity included; unbounded for any other
// name.
Range range_of(std::string_view metric);

}  // namespace salbench
