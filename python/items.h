// SPDX-License-Identifier: GPL-3.0-or-later
// Items and listings, converted between Python (salbench.datasets.records) and C++ (io/shapes/dataset.h).
#pragma once

#include <pybind11/pybind11.h>

#include "io/shapes/dataset.h"
#include "pipeline/inputs/inputs.h"

namespace salbench::python {

// Converts an Item whose kind is known.
Item item_from(pybind11::handle item, ReadBy read_by);

// Items as a user names them: None for all, text as bytes, or a list of names.
ItemChoice choice_of(pybind11::handle items);

// Data set listed by the front: a Dataset of salbench.datasets.sets with its Listing. `read` is not set.
Dataset dataset_from(pybind11::handle dataset, pybind11::handle listing);

}  // namespace salbench::python
