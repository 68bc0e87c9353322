// SPDX-License-Identifier: GPL-3.0-or-later
// One value per point in NumPy's .npy.
#pragma once

#include <string_view>

#include "stages/core/types.h"

namespace salbench {

bool is_npy(std::string_view bytes);

// Floating-point or whole numbers of at most 64 bits, of either order of bytes; n, n x 1 or 1 x n; any number
// of them, finite or not. Throws InputError, one line that begins with `name`: another type or shape, a whole
// number that no double is equal to, a file that is cut short, or no such file.
ScalarField parse_npy(std::string_view bytes, std::string_view name);

}  // namespace salbench
