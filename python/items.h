// SPDX-License-Identifier: GPL-3.0-or-later
// Items and listings of data sets, between Python (salbench.datasets.records) and C++ (io/shapes/dataset.h).
#pragma once

#include <pybind11/pybind11.h>

#include "io/shapes/dataset.h"
#include "pipeline/inputs/inputs.h"

namespace salbench::python {

// Converts an Item whose kind is settled.
Item item_from(pybind11::handle item, ReadBy read_by);

// Items as a user names them: None for all, a text as bytes, or a list of names.
ItemChoice choice_of(pybind11::handle items);

// A data set that the front has listed: a Dataset of salbench.datasets.sets, and its Listing. `read` is not
// set.
Dataset dataset_from(pybind11::handle dataset, pybind11::handle listing);

}  // namespace salbench::python
