// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/function_model.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

// Section of a configuration that recorded_function_model reads.
std::string section_text(const FunctionModel& function) {
  std::string yaml;
  if (!function.description.empty())
    yaml += fmt::format("description: {}\n", yaml_quoted(function.description));
  if (!function.trained_keys.empty()) yaml += fmt::format("trained: {}\n", yaml_quoted(function.trained));
  yaml += fmt::format("function: {}\nreads: {}\nversion: {}\n", yaml_scalar(function.key),
                      option_text(function.reads), function.version);
  if (!function.trained_on.empty())
    yaml += fmt::format("trained_on: {}\n", option_text(function.trained_on, true));
  std::map<std::string, Words> shapes_by_key;
  for (const auto& [shape, key] : function.trained_keys) shapes_by_key[key].push_back(shape);
  if (!shapes_by_key.empty()) yaml += "training:\n";
  for (const auto& [key, shapes] : shapes_by_key)
    yaml += fmt::format("  {}: {}\n", yaml_scalar(key), option_text(shapes, true));
  return yaml;
}

// The shape's name is passed to functions that receive its files, and then enters the key. For trained models
// the key of the shape's training enters: retraining one fold keeps the maps of the others.
KeyText told_of(const FunctionModel& function, const ShapeOutputs& shape) {
  if (shape.originals) return shape.names;
  if (function.trained_keys.empty()) return {};
  return {"training", [keys = function.trained_keys, names = shape.names.of](Unit unit) {
            const auto key = keys.find(names(unit).value());
            return key == keys.end() ? std::string() : key->second;
          }};
}

Output<ScalarField> add_function(RuleTable& table, const ShapeOutputs& shape, const FunctionModel& function,
                                 const FunctionCall& call) {
  const std::string lines =
      fmt::format("function: {}\nreads: {}\n", function.key, option_text(function.reads));
  RuleHead head = stage_of(function.name, Role::map, function.version);
  head.limit = 1;
  const auto checked = [call](const FunctionInput& input) {
    ScalarField map = call(input);
    require_finite(map, "the map");
    return map;
  };
  return add_own_map(table, shape,
                     {.head = head,
                      .reads = function.reads,
                      .options = {"models." + function.name, lines, lines},
                      .told = told_of(function, shape),
                      .seeded = true,
                      .call = checked});
}

}  // namespace

Output<ScalarField> add_own_map(RuleTable& table, const ShapeOutputs& shape, const OwnMap& map) {
  const auto reads = [&](std::string_view part) {
    return std::ranges::find(map.reads, part) != map.reads.end();
  };
  RuleHead head = map.head;
  head.is_foreign = true;
  const OfJob<UnitName> name = {[seeded = map.seeded](Rule& rule) { rule.seeded = seeded; }, kName.get};
  return table.add(
      shape.level, head,
      [call = map.call](Points points, const Normals* normals, Surface faces, const Descriptors* fpfh,
                        Surface mapped_faces, const UnitName& item, const Files& originals, const UnitText&,
                        const NoOptions&) {
        FunctionInput input{item.text, points, normals, faces, fpfh, mapped_faces.size()};
        if (!originals.data.empty())
          input.source = std::filesystem::absolute(item_of(originals.source).file).string();
        return call(input);
      },
      shape.points, only_if(reads("normals"), shape.normals), only_if(reads("faces"), shape.surface),
      only_if(reads("fpfh"), shape.fpfh), shape.mapped_faces(), name, files_of(shape.originals),
      text_of(map.told), SectionOf<NoOptions>{map.options, {}});
}

Model function_model(const FunctionModel& function, FunctionCall call) {
  if (const std::string wrong = wrong_with_model_name(function.name); !wrong.empty())
    throw ConfigError(fmt::format("models: '{}' {}", function.name, wrong));
  const std::string options = section_text(function);
  return {.name = function.name,
          .version = function.version,
          .options = options,
          .annotated_options = options,
          .add_map = [function, call = std::move(call)](
                         RuleTable& table,
                         const ShapeOutputs& shape) { return add_function(table, shape, function, call); },
          .trained_on = function.trained_on,
          .trained = function.trained,
          .reads_originals = std::ranges::find(function.reads, "source") != function.reads.end()};
}

Model recorded_function_model(const std::string& name, const Section& models) {
  if (const std::string wrong = wrong_with_model_name(name); !wrong.empty()) models.fail(name, wrong);
  const Section written = models.child(name);
  written.reject_unknown(
      {"description", "function", "reads", "version", "trained", "trained_on", "training"});
  FunctionModel function{.name = name};
  written.read_value("description", function.description);
  written.read_value("function", function.key);
  written.read_value("reads", function.reads);
  written.read_value("version", function.version);
  written.read_value("trained", function.trained);
  written.read_value("trained_on", function.trained_on);
  const Section training = written.child("training");
  for (const std::string& key : training.keys())
    for (const std::string& shape : training.words(key)) function.trained_keys[shape] = key;
  return function_model(function, [name](const FunctionInput& input) -> ScalarField {
    throw InputError(
        fmt::format("{} is a function of Python: its map of {} is not in the cache; run it again from "
                    "Python, or leave it out with --models",
                    name, input.item));
  });
}

}  // namespace salbench
