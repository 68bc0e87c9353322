// What a stage may produce, and how each kind is laid out as named arrays: the one table of the data sets in
// an artefact (docs/data_dictionary.md).
#pragma once

#include <string_view>
#include <variant>

#include "io/arrays.h"
#include "stages/core/types.h"

namespace salbench {

using Value = std::variant<Mesh, Scan, Normals, Faces, Descriptors, ScalarField, GroundTruth, Histogram,
                           Scores, HumanCurve>;

Arrays arrays_from(const Value& value);

std::string_view kind_of(const Value& value);  // "mesh", "scan", ... : the name of the layout

// The inverse, exact to the bit. Throws InputError where an array is missing or of another shape or type.
Value value_from(std::string_view kind, const Arrays& arrays);

}  // namespace salbench
