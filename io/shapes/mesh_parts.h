// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the parsers of mesh formats.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "stages/core/types.h"

namespace salbench {

inline constexpr std::int64_t kMaxVertices = std::numeric_limits<std::int32_t>::max();

// The functions wrong_with_* describe the error in a value; empty if there is none.

// Non-finite coordinates and those beyond kLargestCoordinate are wrong.
std::string_view wrong_with_point(const Vec3& point);
std::string wrong_with_count(std::int64_t count, std::string_view plural);  // plural: "vertices" or "faces"
std::string wrong_with_polygon(double n_vertices);

std::string index_out_of_range(double index, std::int64_t first, std::int64_t n_vertices);

}  // namespace salbench
