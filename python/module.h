// SPDX-License-Identifier: GPL-3.0-or-later
// Functions by which this folder's files extend the module, and the exceptions seen by Python.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <pybind11/pybind11.h>

namespace salbench::python {

// "; did you mean 'auc'?", or a list of the names if there are few; else empty.
std::string hint(std::string_view name, const std::vector<std::string_view>& known);
// KeyError: "there is no metric 'aucs'; did you mean 'auc'?"
[[noreturn]] void fail_unknown(std::string_view what, std::string_view name,
                               const std::vector<std::string_view>& known);

// Row of a table by name; KeyError if there is none.
template <class Rows, class Name = std::identity>
const auto& row_named(std::string_view what, std::string_view name, const Rows& rows, Name name_of = {}) {
  const auto found = std::ranges::find(rows, name, name_of);
  if (found != std::ranges::end(rows)) return *found;
  std::vector<std::string_view> known;
  for (const auto& row : rows) known.push_back(std::invoke(name_of, row));
  fail_unknown(what, name, known);
}

void bind_cache(pybind11::module_& module);
void bind_commands(pybind11::module_& module);
void bind_form(pybind11::module_& module);
void bind_gaze(pybind11::module_& module);
void bind_items(pybind11::module_& module);
void bind_maintain(pybind11::module_& module);
void bind_metrics(pybind11::module_& module);
void bind_models(pybind11::module_& module);
void bind_plan(pybind11::module_& module);
void bind_reading(pybind11::module_& module);
void bind_run(pybind11::module_& module);
void bind_shapes(pybind11::module_& module);

}  // namespace salbench::python
