// SPDX-License-Identifier: GPL-3.0-or-later
// Converts Settings and Functions (salbench/runs/settings.py, models/function.py) to a Request.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <string>

#include <pybind11/pybind11.h>

#include "pipeline/rules/function_model.h"
#include "pipeline/run/request.h"

namespace salbench::python {

// A model that is a Python function.
struct OwnModel : FunctionModel {
  explicit OwnModel(pybind11::handle row);

  pybind11::object function;
  pybind11::object learner;  // the function if it trains models on demand, else None
  mutable std::map<std::string, std::string> traces = {};  // by shape: traceback of its exception
};
using OwnModels = std::deque<OwnModel>;
OwnModels own_models(const pybind11::list& functions);

// Map computed by the function. Needs the interpreter's lock. Throws InputError, one line with the innermost
// line of the user's code: "ValueError: bad (model.py, line 12)".
ScalarField call(const OwnModel& model, const FunctionInput& input);

// `functions` must outlive the request. The threads of the run call them through `call`.
using CallOwn = std::function<ScalarField(const OwnModel& model, const FunctionInput& input)>;
Request request_from(pybind11::handle settings, const OwnModels& functions = {}, const CallOwn& call = {});

}  // namespace salbench::python
