// SPDX-License-Identifier: GPL-3.0-or-later
// Between a Shape of salbench.datasets.records and a shape in the HDF5 form (io/hdf5/one_form.h).
#pragma once

#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "io/hdf5/one_form.h"

namespace salbench::python {

// Converts a Shape, or an object with its attributes; its ground truth is of `view`. Throws py::value_error.
ShapeInForm shape_from(pybind11::handle shape, const std::string& view);

// Fields of a Shape without its ground truth, and `truths`: a dict of fields of it by view.
pybind11::dict fields_of(ShapeInForm shape);

std::vector<Vec3> triples_of(pybind11::handle array, const char* name);

}  // namespace salbench::python
