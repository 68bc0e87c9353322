// SPDX-License-Identifier: GPL-3.0-or-later
// A shape with its ground truth in the one HDF5 form that data sets are imported into; docs/hdf5_form.md has
// it.
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
  std::string view = {};  // that is scored by itself; empty: the shape
  GroundTruth truth = {};
  ScalarField face_values = {};  // f, as published; empty: values are not per face
};

using TextAttributes = std::vector<std::pair<std::string, std::string>>;

struct ShapeInForm {
  Mesh mesh = {};            // as the file has it, polygons split
  PolygonCounts polygons{};  // that were split
  bool is_cloud = false;     // then there is no mesh
  PointCloud cloud = {};     // as it is scored
  std::vector<TruthInForm> truths = {};
  GazeRecording recording = {};  // of people who looked at the shape; empty: there is none
  TextAttributes about = {};     // item, source, licence and the like
  std::string remark = {};       // on rows that cannot be used: one line; it is in no file
};

Bytes one_form_image(const ShapeInForm& shape);  // equal shapes give equal bytes

// All of it but `about` and `remark`. `shape_in_arrays` is the inverse, and throws as the functions below do.
Arrays one_form_arrays(const ShapeInForm& shape);
ShapeInForm shape_in_arrays(const Arrays& arrays, std::string_view name);

// The shape of an image; nothing if no program of ours wrote the bytes, or something has
// changed them. This and what follows throw InputError, one line that begins with `name`, for what is no such
// file: arrays that are missing, of another type or size, or refer to points that there are not.
// `view`: the ground truth of that one alone, if it is there; what is wrong with others is no error then.
std::optional<ShapeInForm> shape_in_form(std::string_view image, std::string_view name,
                                         std::optional<std::string_view> view = {});

// Throws InputError if the image says that it is of another item than this one.
void require_form_of(std::string_view item, std::string_view image, std::string_view name);

}  // namespace salbench
