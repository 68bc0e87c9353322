// SPDX-License-Identifier: GPL-3.0-or-later
// The application's side of binding.h: roles of results, and views of them.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "io/hdf5/value.h"
#include "pipeline/config/option_text.h"
#include "pipeline/engine/binding.h"

namespace salbench {

// --- roles -------------------------------------------------------------------------------------------------

// Meaning of an output for any level and model. Its name is that of its stage, before the model's.
enum class Role {
  import,  // shape with ground truth from files of other programs
  shape,
  ground_truth,
  reference,  // mean histogram of the ground truth, target of matching
  normals,
  surface,
  fpfh,
  map,
  matched,
  mean_histogram,
  scores,
  score_table,
  curve,  // human performance by number of participants
  picture,
  centre_density,    // ground truth of a shape by distance from the centroid
  centre_densities,  // sum of centre_density over a set
  smoothed_scores,   // scores of the map after each number of smoothing steps
  smoothed_table,    // [shape][steps], flattened
  face_map,          // map per face, if faces are scored
  fixations,         // fixations of recorded people
  gaze_hits,         // their positions on the shape
  visible_shares,    // durations for which people could see each vertex
};
template <>
struct EnumNames<Role> {
  static constexpr std::array<std::string_view, 22> names{
      "import",   "shape",     "ground_truth",   "reference",        "normals",         "surface",
      "fpfh",     "map",       "matched",        "mean_histogram",   "scores",          "score_table",
      "curve",    "picture",   "centre_density", "centre_densities", "smoothed_scores", "smoothed_table",
      "face_map", "fixations", "gaze_hits",      "visible_shares"};
};
inline bool has_role(const Rule& rule, Role role) { return rule.role == static_cast<int>(role); }

// Head of a stage named after its role, or as given.
inline RuleHead stage(Role role, std::int32_t version, std::string_view name = {}) {
  return {static_cast<int>(role), {}, std::string(name.empty() ? name_of(role) : name), version};
}
// Head of a model's stage: "map.LS".
inline RuleHead stage_of(const std::string& model, Role role, std::int32_t version) {
  return {static_cast<int>(role), model, std::string(name_of(role)) + "." + model, version};
}

// --- views -------------------------------------------------------------------------------------------------

template <>
struct View<FieldView, ScalarField> {
  static FieldView of(const ScalarField& field) { return field; }
};

template <>
struct View<Points, Mesh> {
  static Points of(const Mesh& mesh) { return mesh.vertices; }
};
template <>
struct View<Points, Scan> {
  static Points of(const Scan& scan) { return scan.points; }
};
template <>
struct View<Points, PointCloud> {
  static Points of(const PointCloud& cloud) { return cloud.points; }
};

// Points of any kind of shape; throws std::bad_any_cast.
inline Points points_in(const std::any& shape) {
  if (const auto* mesh = value_if<Mesh>(shape)) return mesh->vertices;
  if (const auto* scan = value_if<Scan>(shape)) return scan->points;
  return value_as<PointCloud>(shape).points;
}

template <>
struct View<Surface, Mesh> {
  static Surface of(const Mesh& mesh) { return mesh.faces; }
};
template <>
struct View<Surface, Faces> {
  static Surface of(const Faces& faces) { return faces; }
};

}  // namespace salbench
