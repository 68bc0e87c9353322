// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/request.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/shapes/values_file.h"
#include "python/arrays.h"
#include "python/front.h"
#include "python/items.h"
#include "python/texts.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

// One-line summary, and complete traceback.
std::pair<std::string, std::string> what_was_raised(const py::error_already_set& error) {
  const py::object trace = error.trace() ? py::object(error.trace()) : py::none();
  return py::module_::import("salbench.runs.hooks")
      .attr("raised")(error.value(), trace)
      .cast<std::pair<std::string, std::string>>();
}

std::string text_or_empty(py::handle settings, const char* key) {
  const py::object value = settings.attr(key);
  return value.is_none() ? std::string() : file_bytes(py::str(value));
}

std::optional<std::string> text_if_given(py::handle settings, const char* key) {
  if (settings.attr(key).is_none()) return {};
  return text_or_empty(settings, key);
}

Pictures pictures_from(py::handle settings) {
  const std::string name = text_or_empty(settings, "pictures");
  return name == "computed" ? Pictures::computed : name == "cached" ? Pictures::cached : Pictures::none;
}

}  // namespace

OwnModel::OwnModel(py::handle row)
    : FunctionModel{.name = row.attr("name").cast<std::string>(),
                    .reads = row.attr("reads").cast<Words>(),
                    .version = row.attr("version").cast<std::int32_t>(),
                    .key = row.attr("key").cast<std::string>(),
                    .trained_keys = row.attr("trained_keys").cast<std::map<std::string, std::string>>(),
                    .trained = row.attr("trained").cast<std::string>(),
                    .trained_on = row.attr("trained_on").cast<Words>(),
                    .description = row.attr("description").cast<std::string>()},
      function(row.attr("predict")),
      learner(row.attr("learner")) {}

OwnModels own_models(const py::list& functions) {
  OwnModels models;
  for (const py::handle row : functions) models.emplace_back(row);
  return models;
}

ScalarField call(const OwnModel& model, const FunctionInput& input) {
  try {
    const bool reads_faces = std::ranges::find(model.reads, "faces") != model.reads.end();
    const std::size_t n = input.points.size();
    const py::object values = model.function(shape_of(input, reads_faces));
    const auto map =
        map_values({values, "the map"}, input.mapped_faces == 0 ? std::optional(n) : std::nullopt);
    require_value_per_element(fmt::format("{}(): the map", model.name), map.size(), n, input.mapped_faces);
    return map.copy();
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;  // Ctrl-C, and sys.exit()
    auto [line, trace] = what_was_raised(error);
    model.traces[input.item] = std::move(trace);
    throw InputError(fmt::format("{}() raised {}", model.name, line));
  } catch (const py::builtin_exception& error) {
    throw InputError(fmt::format("{}(): {}", model.name, error.what()));
  }
}

Request request_from(py::handle settings, const OwnModels& functions, const CallOwn& call_own) {
  Request request{.config = text_or_empty(settings, "path"),
                  .yaml = text_if_given(settings, "yaml"),
                  .models = text_or_empty(settings, "models"),
                  .kept = text_if_given(settings, "kept"),
                  .functions = {},
                  .maps = {},
                  .matched = settings.attr("matched").cast<bool>(),
                  .data = text_or_empty(settings, "data"),
                  .cache = text_or_empty(settings, "cache"),
                  .output = text_or_empty(settings, "out"),
                  .items = choice_of(settings.attr("items")),
                  .split = text_if_given(settings, "split"),
                  .shard = text_or_empty(settings, "shard"),
                  .pictures = pictures_from(settings),
                  .cached_alone = settings.attr("cached_alone").cast<bool>(),
                  .keep_going = settings.attr("keep_going").cast<bool>()};
  for (const auto& [name, source] : settings.attr("maps").cast<py::dict>())
    request.maps[file_bytes(name)] = file_bytes(source);
  for (const OwnModel& model : functions)
    request.functions.push_back(function_model(
        model, [call_own, &model](const FunctionInput& input) { return call_own(model, input); }));
  if (const py::object reference = settings.attr("reference"); py::isinstance<py::str>(reference))
    request.reference_of_items = true;
  else
    request.reference = histogram({reference, "reference"});
  return request;
}

}  // namespace salbench::python
