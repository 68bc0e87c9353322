// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the parsers of mesh formats.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "io/shapes/text_scanner.h"
#include "stages/core/types.h"

namespace salbench {

inline constexpr std::int64_t kMaxVertices = std::numeric_limits<std::int32_t>::max();

// The functions wrong_with_* describe what is wrong with a value; empty if nothing.

// Stages square distances, which must not overflow.
std::string_view wrong_with_point(const Vec3& point);
std::string wrong_with_count(std::int64_t count, std::string_view plural);  // of vertices or faces
std::string wrong_with_polygon(std::int64_t n_vertices);

std::string index_out_of_range(std::int64_t index, std::int64_t first, std::int64_t n_vertices);

Vec3 read_point(TextScanner& in);  // the next three numbers of the line

// Number of records to reserve memory for: as announced by a header, but no more than `bytes` can hold.
inline std::size_t room_for(std::int64_t announced, std::size_t bytes) {
  constexpr std::size_t kMinBytesPerRecord = 6;  // "0 0 0\n"
  return std::min(static_cast<std::size_t>(announced), bytes / kMinBytesPerRecord);
}

}  // namespace salbench
