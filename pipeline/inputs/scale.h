// SPDX-License-Identifier: GPL-3.0-or-later
// Remarks on coordinates that can be used, and hint at a wrong unit or at lost digits.
#pragma once

#include <span>
#include <string>

#include "stages/core/types.h"

namespace salbench {

// One line; empty for what is usual. Nothing that is computed depends on the unit of length.
std::string odd_scale(std::span<const Vec3> points);

}  // namespace salbench
