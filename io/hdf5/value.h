// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of values that stages produce, and the layout of each as named arrays: the one definition of the
// data sets in an artefact (docs/data_dictionary.md).
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "io/arrays.h"
#include "io/hdf5/one_form.h"
#include "stages/core/centre.h"
#include "stages/core/picture.h"
#include "stages/core/point_cloud.h"
#include "stages/core/types.h"

namespace salbench {

// The scores of many shapes, so that tables need one file and not one per shape.
struct ScoreTable {
  std::vector<Scores> rows;  // in the order of the shapes
};

using Value = std::variant<Mesh, Scan, Normals, Faces, Descriptors, ScalarField, GroundTruth, Histogram,
                           Scores, HumanCurve, Picture, PointCloud, ScoreTable, CentreDensity, ShapeInForm>;

Arrays arrays_from(const Value& value);

std::string_view kind_of(const Value& value);  // "mesh", "scan", ... : the name of the layout

// The inverse, exact to the bit. Throws InputError if an array is missing or has another shape or type.
Value value_from(std::string_view kind, const Arrays& arrays);

}  // namespace salbench
