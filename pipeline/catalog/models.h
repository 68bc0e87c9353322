// SPDX-License-Identifier: GPL-3.0-or-later
// The table of models. A new saliency model is its file pair in stages/models and one row here; its section
// in a configuration and what it reads follow from its signature. HS has a row like the others, and is scored
// in its own way.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>

#include "pipeline/catalog/row.h"
#include "pipeline/config/section.h"
#include "stages/models/hs.h"

namespace salbench {

struct GivenMaps;  // pipeline/catalog/given_maps.h

// The rows of one kind of shapes that a model may read, by the type of the parameter that they stand for.
struct ShapeRows {
  Shapes shapes = Shapes::meshes;
  RowOf<Points> points = {};
  RowOf<Normals> normals = {};
  RowOf<Surface> surface = {};  // of scans and point clouds: the partial mesh
  RowOf<Descriptors> fpfh = {};
  RowOf<GroundTruth> ground_truth = {};
  RowOf<Histogram> reference = {};
};

// A model with its options bound: a map of every shape, computed or given, or, as HS alone, human
// performance.
struct Model {
  std::string name;
  std::int32_t version = 0;  // raised when the model's output changes: old artefacts are then not used
  std::string options = {};  // canonical text
  std::string annotated_options = {};  // with a comment above each option
  std::function<RowOf<ScalarField>(Catalog&, const ShapeRows&, RowHead)> add_map = {};
  std::optional<HsOptions> human = {};
  std::shared_ptr<const GivenMaps> given = {};

  bool is_map() const { return add_map != nullptr || given != nullptr; }
};

struct ModelRow {
  std::string_view name;
  // Reads the model's section over the defaults of the protocol.
  std::function<Model(const Section& section, Protocol protocol)> bind;
  bool by_default = true;  // runs if a configuration names no models
  // People or chance: what models are measured against, and no competitor in a ranking.
  bool is_reference = false;
};

namespace binding {

// The argument that stands for a model's parameter.
template <class Parameter, class Options>
auto argument_for(const ShapeRows& rows, const SectionOf<Options>& section) {
  if constexpr (std::is_same_v<Parameter, Options>) return section;
  if constexpr (std::is_same_v<Parameter, Points>) return rows.points;
  if constexpr (std::is_same_v<Parameter, Normals>) return rows.normals;
  if constexpr (std::is_same_v<Parameter, Surface>) return rows.surface;
  if constexpr (std::is_same_v<Parameter, Descriptors>) return rows.fpfh;
  if constexpr (std::is_same_v<Parameter, RandomSource>) return kRandom;
}

}  // namespace binding

// The options of a model for a kind of shapes, where its struct tells scans apart. Point clouds count as
// meshes: their points have been chosen by somebody, and are no grid of rays.
template <class Options>
Options options_for(const Options& options, Shapes shapes) {
  if constexpr (requires { options.of_scans(); })
    return shapes == Shapes::scans ? options.of_scans() : options.of_meshes();
  else
    return options;
}

// A row of the table, from the model's function; its options are the last parameter.
template <class... Parameters>
ModelRow model_row(std::string_view name, std::int32_t version, ScalarField (*saliency)(Parameters...)) {
  using All = std::tuple<std::decay_t<Parameters>...>;
  using Options = std::tuple_element_t<sizeof...(Parameters) - 1, All>;
  return {name, [=](const Section& written, Protocol protocol) {
            auto options = preset<Options>(protocol);
            written.read(options);
            const auto add_map = [=](Catalog& catalog, const ShapeRows& rows, RowHead head) {
              const auto bound = section("models." + std::string(name), options_for(options, rows.shapes));
              return catalog.add(rows.shapes, std::move(head), saliency,
                                 binding::argument_for<std::decay_t<Parameters>>(rows, bound)...);
            };
            return Model{.name = std::string(name),
                         .version = version,
                         .options = options_text(options),
                         .annotated_options = annotated_options_text(options),
                         .add_map = add_map};
          }};
}

std::span<const ModelRow> model_rows();

// A map that has one value everywhere: a reference beside chance, with scores and without maps.
inline constexpr std::string_view kConstantMap = "constant";
inline constexpr std::string_view kChance = "RS";

bool is_reference_model(std::string_view name);  // by its row; false for a name that has none

}  // namespace salbench
