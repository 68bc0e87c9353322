// SPDX-License-Identifier: GPL-3.0-or-later
// Values that stages produce, and the layout of each as named arrays: the only definition of the data sets in
// an artefact (docs/data_dictionary.md).
#pragma once

#include <concepts>
#include <string_view>
#include <vector>

#include "io/arrays.h"
#include "io/hdf5/one_form.h"
#include "stages/core/gaze.h"
#include "stages/core/picture.h"
#include "stages/core/types.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

// Scores of many shapes: a table then reads one file, not one per shape.
struct ScoreTable {
  std::vector<Scores> rows;  // in the order of the shapes
};

template <class T, class... Known>
concept OneOf = (std::same_as<T, Known> || ...);

template <class T>
concept Storable = OneOf<T, Mesh, Scan, Normals, Faces, Descriptors, ScalarField, GroundTruth, Histogram,
                         Scores, HumanCurve, Picture, PointCloud, ScoreTable, CentreDensity, ShapeInForm,
                         GazeFixations, GazeHits, VisibleShares>;

template <Storable T>
struct ArrayForm<T> {
  static const std::string_view kind;  // "mesh", "scan", ...
  static Arrays arrays(const T& value);
  // The inverse, bit for bit. Throws InputError if an array is missing or has a wrong shape or type.
  static T read(const Arrays& arrays);
};

}  // namespace salbench
