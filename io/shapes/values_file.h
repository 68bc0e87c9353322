// SPDX-License-Identifier: GPL-3.0-or-later
// Files of values and of picks: ground truth in the Schelling study's format [chen2012], and one value per
// point or face, as other programs write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Points of a shape: their number, and their name in messages.
struct Elements {
  static constexpr std::size_t kUnknown = std::numeric_limits<std::size_t>::max();
  std::size_t n = kUnknown;
  std::string_view shape = "mesh", one = "vertex", plural = "vertices";
  // End of the message on a wrong number of values: matching other elements, and advice.
  std::function<std::string(std::size_t count)> others = {};
};

// Both throw InputError, one line "PATH:LINE: problem". Blank lines and comments are skipped: lines that
// begin with '#', and in files of indices also the rest of a line after '#'. The first line may be a column
// name.

// Finite numbers, one per line (.val), exactly as many as the shape has points, if that is known.
ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements = {});

// 0-based indices, one per line (.pid), in the file's order; also written as 3.0. Files without any are valid
// data.
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, const Elements& elements);

// Throws InputError, one line that begins with `name`, unless there are as many values as points, or as faces
// if these may have values too.
void require_value_per_element(std::string_view name, std::size_t n_values, std::size_t n_points,
                               std::size_t n_faces = 0);

}  // namespace salbench
