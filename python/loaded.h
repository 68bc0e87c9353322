// SPDX-License-Identifier: GPL-3.0-or-later
// A shape with its ground truth as a run has it, in arrays that keep it alive.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "io/hdf5/one_form.h"
#include "pipeline/inputs/inputs.h"

namespace salbench::python {

// The mesh, or the partial one of a point cloud.
Mesh surface_mesh(const ShapeInForm& shape);

// With saliency made from picks where there is none, over the partial mesh of a point cloud.
ShapeInForm with_saliency(ShapeInForm usable);

// points, faces, normals, and of the first truth saliency, participants, viewers; None where there are none.
pybind11::tuple arrays_of(const std::shared_ptr<const ShapeInForm>& shape);

// Items as a user names them: None for all, a text as bytes, or a list of names.
ItemChoice choice_of(pybind11::handle items);

// Names and paths as the system has them, which may be no UTF-8.
pybind11::str file_text(const std::string& bytes);
std::string file_bytes(pybind11::handle text);  // its inverse
pybind11::list file_texts(const std::vector<std::string>& all);

}  // namespace salbench::python
