// Shared by the parsers of mesh formats.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/text_scanner.h"
#include "stages/core/types.h"

namespace salbench {

inline constexpr std::int64_t kMostVertices = std::numeric_limits<std::int32_t>::max();

// Describes what is wrong with a position; empty if nothing. Stages square distances, which must not
// overflow.
std::string_view wrong_with_point(const Vec3& point);

// The next three numbers of the line.
Vec3 read_point(TextScanner& in);

// Splits a polygon into triangles around its first vertex.
void append_fan(std::vector<Triangle>& faces, std::span<const std::int32_t> polygon);

// How many records to make room for: what a header announces, but no more than so many bytes can hold.
inline std::size_t room_for(std::int64_t announced, std::size_t bytes) {
  constexpr std::size_t kFewestBytesPerRecord = 6;  // "0 0 0\n"
  return std::min(static_cast<std::size_t>(announced), bytes / kFewestBytesPerRecord);
}

// Describes what is wrong with a number of vertices or faces; empty if nothing.
std::string wrong_with_count(std::int64_t count, std::string_view plural);

// Describes what is wrong with a face of so many vertices; empty if nothing.
std::string wrong_with_polygon(std::int64_t n_vertices);

std::string index_out_of_range(std::int64_t index, std::int64_t first, std::int64_t n_vertices);

}  // namespace salbench
