// SPDX-License-Identifier: GPL-3.0-or-later
// What a run asks of Python (pipeline/inputs/front.h): functions of salbench/_hooks.py, called by the thread
// that needs them, which takes the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include "pipeline/inputs/front.h"

namespace salbench::python {

Front python_front();

// Of processes that commands and readers are: before a run, where those at work are to end, and after a run.
// With the interpreter's lock.
void allow_hooks();
void end_hooks();
void finish_hooks();

// A Shape of salbench/_shape.py; its faces are None if the function does not read them.
pybind11::object shape_of(const FunctionInput& input, bool reads_faces);

}  // namespace salbench::python
