// SPDX-License-Identifier: GPL-3.0-or-later
// The subject's side of binding.h: how results are held, what they provide, and the roles that they have.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "io/hdf5/value.h"
#include "pipeline/config/option_text.h"
#include "pipeline/engine/binding.h"

namespace salbench {

// --- roles -------------------------------------------------------------------------------------------------

// Meaning of an output, whatever the level and the model. Its name is that of its stage, before the model's.
enum class Role {
  import,  // of a shape and its ground truth, from files that other programs wrote
  shape,
  ground_truth,
  reference,  // mean histogram of the ground truth, which maps are matched to
  normals,
  surface,
  fpfh,
  map,
  matched,
  mean_histogram,
  scores,
  score_table,
  curve,  // of human performance over the number of participants
  picture,
  centre_density,    // of the ground truth of a shape
  centre_densities,  // their sum over a set
  smoothed_scores,   // of the map after each number of smoothing steps
  smoothed_table,    // [shape][steps], one after the other
};
template <>
struct EnumNames<Role> {
  static constexpr std::array<std::string_view, 18> names{
      "import", "shape",   "ground_truth",   "reference",        "normals",         "surface",
      "fpfh",   "map",     "matched",        "mean_histogram",   "scores",          "score_table",
      "curve",  "picture", "centre_density", "centre_densities", "smoothed_scores", "smoothed_table"};
};
inline bool has_role(const Rule& rule, Role role) { return rule.role == static_cast<int>(role); }

// A stage whose name is that of its role, or its own.
inline RuleHead stage(Role role, std::int32_t version, std::string_view name = {}) {
  return {static_cast<int>(role), {}, std::string(name.empty() ? name_of(role) : name), version};
}
// A model's: "map.LS".
inline RuleHead stage_of(const std::string& model, Role role, std::int32_t version) {
  return {static_cast<int>(role), model, std::string(name_of(role)) + "." + model, version};
}

// Outputs that have a type in common.
struct Map {
  using Type = ScalarField;
};
struct Matched {
  using Type = ScalarField;
};
struct Reference {
  using Type = Histogram;
};

struct CentreDensities {
  using Type = CentreDensity;
};

// --- types -------------------------------------------------------------------------------------------------

template <class T, class Variant>
inline constexpr bool kIsAlternative = false;
template <class T, class... Types>
inline constexpr bool kIsAlternative<T, std::variant<Types...>> = (std::is_same_v<T, Types> || ...);

struct ValueCodec {
  using Type = Value;
  static std::string_view kind(const Value& value) { return kind_of(value); }
  static Arrays arrays(const Value& value) { return arrays_from(value); }
  static Value read(std::string_view kind, const Arrays& arrays) { return value_from(kind, arrays); }
};
template <class T>
requires kIsAlternative<T, Value>
struct Holder<T> {
  using Codec = ValueCodec;
};

inline const Value& value_of(const Stored& stored) {
  return dynamic_cast<const Held<ValueCodec>&>(stored).value;
}

template <>
inline constexpr bool kProvides<FieldView, ScalarField> = true;
template <>
struct Part<FieldView> {
  static FieldView of(const Stored& stored) { return value_as<ScalarField>(stored); }
};

template <>
inline constexpr bool kProvides<Points, Mesh> = true;
template <>
inline constexpr bool kProvides<Points, Scan> = true;
template <>
inline constexpr bool kProvides<Points, PointCloud> = true;
template <>
struct Part<Points> {
  static Points of(const Stored& stored) {
    if (const Mesh* mesh = value_if<Mesh>(stored)) return mesh->vertices;
    const Scan* scan = value_if<Scan>(stored);
    return scan != nullptr ? Points(scan->points) : Points(value_as<PointCloud>(stored).points);
  }
};

template <>
inline constexpr bool kProvides<Surface, Mesh> = true;
template <>
inline constexpr bool kProvides<Surface, Faces> = true;
template <>
struct Part<Surface> {
  static Surface of(const Stored& stored) {
    const Mesh* mesh = value_if<Mesh>(stored);
    return mesh != nullptr ? Surface(mesh->faces) : Surface(value_as<Faces>(stored));
  }
};

}  // namespace salbench
