// SPDX-License-Identifier: GPL-3.0-or-later
// Reads what people marked on a mesh. [chen2012]
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "io/truth_format.h"
#include "stages/core/types.h"

namespace salbench {

// All throw InputError, one line "PATH:LINE: what is wrong". Blank lines are skipped.

ScalarField parse_values(std::string_view text, std::string_view name);  // finite numbers, one per line

// The same, exactly n_vertices of them (.val).
ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices);

// Vertex indices, one per line (.pid), the first vertex being number `base` in the file; 0-based here, in the
// file's order. A participant who marked nothing is real data.
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, std::size_t n_vertices,
                                      std::int32_t base = 0);

// Values as a description says that they are written; the content tells text, .npy and MAT
// from each other.
struct TruthValues {
  ScalarField values;        // one per vertex, face or point; NaN where not seen
  std::vector<Vec3> points;  // of values per point: where they are
};
// `n`: how many there must be; of values per point there may be any number but 0.
TruthValues parse_truth_values(std::string_view bytes, std::string_view name, const ValuesFormat& format,
                               std::size_t n);

// Picks as a description says that they are written, in text or MAT.
std::vector<std::int32_t> parse_truth_picks(std::string_view bytes, std::string_view name,
                                            const IndicesFormat& format, std::size_t n_vertices);

}  // namespace salbench
