// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a Request of the Settings and Functions of salbench/runs/settings.py and models/function.py.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <string>

#include <pybind11/pybind11.h>

#include "pipeline/rules/function_model.h"
#include "pipeline/run/request.h"

namespace salbench::python {

// A model that is a function.
struct OwnModel : FunctionModel {
  explicit OwnModel(pybind11::handle row);

  pybind11::object function;
  pybind11::object learner;  // None, or the function, where it trains when it is called
  mutable std::map<std::string, std::string> traces = {};  // by shape: of what it raised
};
using OwnModels = std::deque<OwnModel>;
OwnModels own_models(const pybind11::list& functions);

// The map that it makes. With the interpreter's lock. Throws InputError, one line with the user's innermost
// line: "ValueError: bad (model.py, line 12)".
ScalarField call(const OwnModel& model, const FunctionInput& input);

// The functions must outlive the request; `call` is how one is called from a thread of the run.
using CallOwn = std::function<ScalarField(const OwnModel& model, const FunctionInput& input)>;
Request request_from(pybind11::handle settings, const OwnModels& functions = {}, const CallOwn& call = {});

}  // namespace salbench::python
