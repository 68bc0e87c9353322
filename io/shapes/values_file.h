// SPDX-License-Identifier: GPL-3.0-or-later
// Files of values and of picks: ground truth as the Schelling study writes it [chen2012], and a value per
// point, or per face, as other programs write it.
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

// The points of a shape: how many there are, and their names in messages.
struct Elements {
  static constexpr std::size_t kUnknown = std::numeric_limits<std::size_t>::max();
  std::size_t n = kUnknown;
  std::string_view shape = "mesh", one = "vertex", plural = "vertices";
  // End of the message about a wrong number of values: which other elements are that many, and what to do.
  std::function<std::string(std::size_t count)> others = {};
};

// Both throw InputError, one line "PATH:LINE: what is wrong". Blank lines are skipped, and so are comments:
// lines that begin with '#', and of indices what follows one.

// Finite numbers, one per line (.val), exactly as many as the shape has points, if that is known; the first
// line may be their name.
ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements = {});

// 0-based indices, one per line (.pid), in the file's order. A participant who marked nothing is real data.
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, const Elements& elements);

// Throws InputError, one line that begins with `name`, unless there are as many values as points, or as faces
// where these may have values too.
void require_value_per_element(std::string_view name, std::size_t n_values, std::size_t n_points,
                               std::size_t n_faces = 0);

}  // namespace salbench
