// SPDX-License-Identifier: GPL-3.0-or-later
// Reads what people marked on a mesh. [chen2012]
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "io/number_table.h"
#include "io/truth_format.h"
#include "stages/core/types.h"

namespace salbench {

// All throw InputError, one line "PATH:LINE: what is wrong". Blank lines and comments are skipped: lines that
// begin with '#', and of indices what follows one.

// Finite numbers, one per line (.val), exactly as many as the shape has elements, if that is known; a header
// may name them and a column beside them that numbers the elements (element_order.h).
ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements = {});

// Indices, one per line (.pid), the first vertex or point being number `base` in the file; 0-based here, in
// the file's order. A participant who marked nothing is real data.
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, const Elements& elements,
                                      std::int32_t base = 0);

// Values as a description says that they are written; the content tells text, .npy and MAT from each other.
struct TruthValues {
  ScalarField values;        // one per vertex, face or point; NaN where not seen
  std::vector<Vec3> points;  // of values per point: where they are
};
// As many as there are elements; of values per point any number but 0, at coordinates that meshes may have
// (wrong_with_point).
TruthValues parse_truth_values(std::string_view bytes, std::string_view name, const ValuesFormat& format,
                               const Elements& elements);

// Picks as a description says that they are written, in text or MAT.
std::vector<std::int32_t> parse_truth_picks(std::string_view bytes, std::string_view name,
                                            const IndicesFormat& format, const Elements& elements);

}  // namespace salbench
