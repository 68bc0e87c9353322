// SPDX-License-Identifier: GPL-3.0-or-later
// A reference histogram from a file, in place of the mean over the data set.
#pragma once

#include <string>

#include "stages/core/types.h"

namespace salbench {

// A density over 100 bins from the column GS of a CSV file; a column that sums to something else is scaled,
// with a warning. Throws InputError or ConfigError, with file and line.
Histogram read_reference(const std::string& path);

}  // namespace salbench
