// SPDX-License-Identifier: GPL-3.0-or-later
// A shape with its ground truth as arrays that keep it alive.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <pybind11/pybind11.h>

#include "io/hdf5/one_form.h"
#include "stages/core/point_cloud.h"
#include "stages/core/types.h"

namespace salbench::python {

struct Loaded {
  std::variant<Mesh, PointCloud> shape;
  std::optional<GroundTruth> truth;
};

// points, faces, normals, ground truth, participants, viewers; None where the files have none.
pybind11::tuple arrays_of(const std::shared_ptr<const Loaded>& loaded);

// Fields of a Form of salbench.datasets.records, its truths as those of a Truth.
pybind11::dict fields_of(ShapeInForm shape);

// The partial mesh, which picks are smoothed over and which hides points from a camera, with the options that
// a configuration has by itself.
Faces surface_of(const PointCloud& cloud);

// Names and paths as the system has them, which may be no UTF-8.
pybind11::str file_text(const std::string& bytes);
std::string file_bytes(pybind11::handle text);  // its inverse

}  // namespace salbench::python
