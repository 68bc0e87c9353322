// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes are passed to and from Python as the data sets of the HDF5 form (io/hdf5/one_form.h): a dict of
// arrays by name, handled by salbench/datasets/records.py.
#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "io/hdf5/one_form.h"

namespace salbench::python {

// Checks the shape. Throws InputError, one line that begins with `file`.
ShapeInForm shape_from(const pybind11::dict& arrays, const std::string& file);

pybind11::dict dict_of(const ShapeInForm& shape);

}  // namespace salbench::python
