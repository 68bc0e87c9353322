// SPDX-License-Identifier: GPL-3.0-or-later
// The HDF5 form: a shape with its ground truth in one file, into which data sets are imported
// (docs/hdf5_form.md).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"
#include "io/shapes/polygons.h"
#include "stages/core/gaze.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

struct TruthInForm {
  std::string view = {};  // separately scored view; empty: the whole shape
  GroundTruth truth = {};
  ScalarField face_values = {};  // f, as published; empty: no values per face
};

using TextAttributes = std::vector<std::pair<std::string, std::string>>;

struct ShapeInForm {
  Mesh mesh = {};            // as in the file, polygons split
  PolygonCounts polygons{};  // polygons that were split
  bool is_cloud = false;     // true: `cloud` is set, not `mesh`
  PointCloud cloud = {};     // as scored
  std::vector<TruthInForm> truths = {};
  GazeRecording recording = {};  // gaze of participants; may be empty
  TextAttributes about = {};     // item, source, licence and the like
  std::string remark = {};       // on unusable rows, one line; not stored in the file
};

Bytes one_form_image(const ShapeInForm& shape);  // equal shapes give equal bytes

// Everything but `about` and `remark`. `shape_in_arrays` is the inverse, and throws like the functions below.
Arrays one_form_arrays(const ShapeInForm& shape);
ShapeInForm shape_in_arrays(const Arrays& arrays, std::string_view name);

// Shape in a file image; nullopt unless one of our programs wrote the bytes, unchanged. This and the
// following functions throw InputError, one line that begins with `name`, for invalid content: arrays that
// are missing, have a wrong type or size, or refer to missing points. `view`: reads only this view's ground
// truth, if it exists, and ignores errors in others.
std::optional<ShapeInForm> shape_in_form(std::string_view image, std::string_view name,
                                         std::optional<std::string_view> view = {});

// Throws InputError if the image names another item.
void require_form_of(std::string_view item, std::string_view image, std::string_view name);

}  // namespace salbench
