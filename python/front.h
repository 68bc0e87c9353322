// SPDX-License-Identifier: GPL-3.0-or-later
// Callbacks of the engine (pipeline/inputs/front.h) that call functions of salbench/runs/hooks.py. The thread
// that needs an answer calls them, and takes the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include "pipeline/inputs/front.h"

namespace salbench::python {

Front python_front();
// The same with the data set that the settings of a run may have, in place of that of a layout and folder.
// The caller has the interpreter's lock.
Front python_front(pybind11::handle settings);

// Processes of commands and readers: allowed before a run, told to end while they work, closed after a run.
// The caller has the interpreter's lock.
void allow_hooks();
void end_hooks();
void finish_hooks();

// A Shape of salbench/shapes/shape.py; its faces are None if the function does not read them.
pybind11::object shape_of(const FunctionInput& input, bool reads_faces);

}  // namespace salbench::python
