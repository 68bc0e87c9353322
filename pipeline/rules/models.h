// SPDX-License-Identifier: GPL-3.0-or-later
// The table of models. A new saliency model is a file pair in stages/models and a row here; its configuration
// section and inputs follow from its signature, its labels from its header. HS has a row too, but is scored
// differently.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/inputs/front.h"
#include "pipeline/rules/given_maps.h"
#include "pipeline/rules/values.h"
#include "stages/models/about.h"
#include "stages/models/hs.h"

namespace salbench {

// An options struct as a section of the configuration.
template <class Options>
SectionOf<Options> section(const std::string& path, const Options& options) {
  return {{path, options_text(options), key_text(options)}, options};
}

// Outputs of one level that a model may read, each selected by a parameter's type.
struct ShapeOutputs {
  Level level = kMeshes;
  Output<Points> points = {};
  Output<PointCloud> cloud = {};  // set if the level is point clouds
  Output<Normals> normals = {};
  Output<Surface> surface = {};  // for scans and point clouds, the partial mesh
  Output<Descriptors> fpfh = {};
  Output<GroundTruth> ground_truth = {};
  Output<Histogram> reference = {};
  // Ground-truth density by distance from the centroid, per shape and per set, for metrics that compare both.
  Output<CentreDensity> centre_density = {};
  Output<CentreDensity> centre_densities = {};
  KeyText names = {};           // names of the shapes
  FilesOfUnits originals = {};  // original files of the shape, for models that receive them
  FilesOfUnits map_files = {};  // maps from outside
  FunctionCall command = {};    // set for a model that is a command
  // Maps are scored on faces: ground truth is per face, and maps may be.
  bool on_faces = false;
  Output<Surface> mapped_faces() const { return on_faces ? surface : Output<Surface>(); }
};

// A model with bound options: yields a map for every shape, computed or given. Only HS yields scores instead.
struct Model {
  std::string name;
  std::int32_t version = 0;  // raised when the model's output changes, which invalidates its artefacts
  std::string options = {};  // canonical text
  std::string annotated_options = {};  // with a comment above each option
  std::vector<OptionRow> option_rows = {};
  std::function<Output<ScalarField>(RuleTable&, const ShapeOutputs&)> add_map = {};
  std::optional<HsOptions> human = {};
  std::shared_ptr<const GivenMaps> given = {};  // set if the map is read, not computed
  // Set for command models: makes the function that runs the command. Throws ConfigError if a file that it
  // depends on is unreadable.
  std::function<FunctionCall(const Front&)> command = {};
  Words trained_on = {};         // items and splits
  std::string trained = {};      // training procedure; empty: not trained, or unknown
  bool reads_originals = false;  // reads ShapeOutputs::originals
};

// Keys of a variant's section (variants.h) besides the options of its model.
inline constexpr std::string_view kModelOfVariant = "model", kGridOfVariants = "grid";

struct ModelRow {
  std::string_view name;
  ModelAbout about;
  // Binds options under the name of the row or of a variant. Later sections override earlier ones, and all
  // override the protocol's defaults.
  std::function<Model(const std::string& name, std::span<const Section> written, Protocol protocol)> bind_as;

  Model bind(const Section& section, Protocol protocol) const {
    return bind_as(std::string(name), {&section, 1}, protocol);
  }
};

template <class Options>
Options options_in(std::span<const Section> written, Protocol protocol) {
  auto options = preset<Options>(protocol);
  for (const Section& section : written)
    section.read(options,
                 std::vector<std::string_view>(section.has(kModelOfVariant) ? 1 : 0, kModelOfVariant));
  return options;
}

namespace binding {

// Output or option passed for a model's parameter.
template <class Parameter, class Options>
auto argument_for(const ShapeOutputs& shape, const SectionOf<Options>& section) {
  if constexpr (std::is_same_v<Parameter, Options>) return section;
  if constexpr (std::is_same_v<Parameter, Points>) return shape.points;
  if constexpr (std::is_same_v<Parameter, Normals>) return shape.normals;
  if constexpr (std::is_same_v<Parameter, Surface>) return shape.surface;
  if constexpr (std::is_same_v<Parameter, Descriptors>) return shape.fpfh;
  if constexpr (std::is_same_v<Parameter, RandomSource>) return kRandom;
}

}  // namespace binding

// Options for the shapes of a level, if the struct distinguishes scans. Point clouds use those of meshes:
// their points are sampled by choice, not by a grid of rays.
template <class Options>
Options options_for(const Options& options, Level level) {
  if constexpr (requires { options.of_scans(); })
    return level == kScans ? options.of_scans() : options.of_meshes();
  else
    return options;
}

template <class Options, class... Parameters>
Output<ScalarField> add_map(RuleTable& table, const ShapeOutputs& shape, const RuleHead& head,
                            const SectionOf<Options>& section, ScalarField (*saliency)(Parameters...)) {
  return table.add(shape.level, head, saliency,
                   binding::argument_for<std::decay_t<Parameters>>(shape, section)...);
}

// A row of the table from the model's function, whose last parameter is its options. `of_points`, if given,
// computes the map of scans and point clouds from their points.
template <class... Parameters, class OfPoints>
ModelRow model_row(std::string_view name, std::int32_t version, const ModelAbout& about,
                   ScalarField (*saliency)(Parameters...), OfPoints of_points) {
  using All = std::tuple<std::decay_t<Parameters>...>;
  using Options = std::tuple_element_t<sizeof...(Parameters) - 1, All>;
  return {name, about, [=](const std::string& called, std::span<const Section> written, Protocol protocol) {
            const auto options = options_in<Options>(written, protocol);
            const auto add = [=](RuleTable& table, const ShapeOutputs& shape) {
              const auto bound = section("models." + called, options_for(options, shape.level));
              RuleHead head = stage_of(called, Role::map, version);
              if (called != name) head.same_as = stage_of(std::string(name), Role::map, version).stage;
              return shape.level == kMeshes ? add_map(table, shape, head, bound, saliency)
                                            : add_map(table, shape, head, bound, of_points);
            };
            return Model{.name = called,
                         .version = version,
                         .options = options_text(options),
                         .annotated_options = options_text(options, true),
                         .option_rows = option_rows(options),
                         .add_map = add};
          }};
}

template <class... Parameters>
ModelRow model_row(std::string_view name, std::int32_t version, const ModelAbout& about,
                   ScalarField (*saliency)(Parameters...)) {
  return model_row(name, version, about, saliency, saliency);
}

std::span<const ModelRow> model_rows();
bool is_built_in_model(std::string_view name);  // true if it has a row

// A map with one value everywhere: a reference like chance, with scores but without stored maps.
inline constexpr std::string_view kConstantMap = "constant";
inline constexpr ModelAbout kConstantAbout = {
    .name = "The same value at every point",
    .is_reference = true,
    .is_floor = true,
};

// False for names that are neither in the table nor the constant map.
bool is_reference_model(std::string_view name);
bool is_floor_model(std::string_view name);

// Stands for all trivial baselines of the table, in a configuration or in --models.
inline constexpr std::string_view kFloors = "floors";

// Reason why a user's model cannot have this name, which appears in tables, folders and keys; empty if it
// can.
std::string wrong_with_model_name(std::string_view name);

// Model whose maps come from outside. Throws ConfigError for a name that is taken or invalid.
Model given_model(const std::string& name, GivenMaps maps);

}  // namespace salbench
