// SPDX-License-Identifier: GPL-3.0-or-later
// Callbacks of the engine (pipeline/inputs/front.h) that call salbench/runs/hooks.py, from the thread that
// needs the answer, with the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include "pipeline/inputs/front.h"

namespace salbench::python {

Front python_front();
// The same, with the data set from a run's settings, if any, in place of a layout and folder. The caller
// holds the interpreter's lock.
Front python_front(pybind11::handle settings);

// Processes of commands and readers: allowed before a run, terminated on request, and closed after a run. The
// caller holds the interpreter's lock.
void allow_hooks();
void end_hooks();
void finish_hooks();

// A Shape (salbench/shapes/shape.py); its faces are None unless the function reads them.
pybind11::object shape_of(const FunctionInput& input, bool reads_faces);

}  // namespace salbench::python
