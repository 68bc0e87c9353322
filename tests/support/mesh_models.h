// SPDX-License-Identifier: GPL-3.0-or-later
// Models that draw no random numbers, from a mesh to its map, with default options; and the same mesh in
// other frames: rotated, scaled, shifted, renumbered.
#pragma once

#include <array>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/rules/models.h"
#include "stages/core/rng.h"
#include "stages/descriptors/fpfh.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/normals/normals.h"

namespace salbench {

// The mesh must outlive it.
struct DescribedMesh {
  const Mesh& mesh;
  Normals normals;
  Descriptors descriptors;

  explicit DescribedMesh(const Mesh& of)
      : mesh(of), normals(mesh_normals(of)), descriptors(fpfh(of.vertices, normals, FpfhOptions{})) {}
  DescribedMesh(const Mesh& of, Normals its_normals, Descriptors its_descriptors)
      : mesh(of), normals(std::move(its_normals)), descriptors(std::move(its_descriptors)) {}
  explicit DescribedMesh(Mesh&&) = delete;

  Points points() const { return mesh.vertices; }
};

// A row of the table of models, called as in a run.
struct MeshModel {
  std::string_view name;
  Rule rule;  // reads the results below

  static constexpr std::size_t kMeshRule = 0, kNormalsRule = 1, kFpfhRule = 2, kRulesBelow = 3;

  ScalarField map(const DescribedMesh& described) const {
    JobInputs inputs;
    for (const std::size_t input : rule.inputs)
      inputs.values.push_back(input == kMeshRule      ? held(described.mesh)
                              : input == kNormalsRule ? held(described.normals)
                                                      : held(described.descriptors));
    return value_as<ScalarField>(*rule.compute(inputs));
  }
};

inline std::vector<MeshModel> models_without_random_numbers() {
  const Output<Mesh> mesh(MeshModel::kMeshRule);
  const ShapeOutputs shape{.points = mesh,
                           .normals = Output<Normals>(MeshModel::kNormalsRule),
                           .surface = mesh,
                           .fpfh = Output<Descriptors>(MeshModel::kFpfhRule)};
  std::vector<MeshModel> models;
  for (const ModelRow& row : model_rows()) {
    const Model model = row.bind(Section::from_text("", ""), Protocol::published);
    if (!model.add_map) continue;
    RuleTable table{Rules(MeshModel::kRulesBelow)};
    model.add_map(table, shape);
    if (!table.rules().back().seeded) models.push_back({row.name, table.rules().back()});
  }
  return models;
}

inline const std::vector<MeshModel> kMeshModels = models_without_random_numbers();

// A mesh in another frame.
struct FramedMesh {
  Mesh mesh;
  std::vector<std::int32_t> number;  // [original vertex]: its number here

  explicit FramedMesh(Mesh before) : mesh(std::move(before)), number(mesh.vertices.size()) {
    std::iota(number.begin(), number.end(), 0);
  }
  template <class Place>
  FramedMesh(Mesh before, const Place& place) : FramedMesh(std::move(before)) {
    for (Vec3& v : mesh.vertices) v = place(v);
  }

  ScalarField in_order_before(const ScalarField& map) const {
    ScalarField values;
    for (const std::int32_t i : number) values.push_back(map[static_cast<std::size_t>(i)]);
    return values;
  }
};

inline Vec3 random_direction(Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return Vec3(x, y, z).normalized();
}

inline FramedMesh randomly_turned(const Mesh& mesh, Rng rng) {
  const Vec3 axis = random_direction(rng);
  // Uniform over all rotations: the angle of a random unit quaternion.
  const double w = rng.normal(), length = std::hypot(rng.normal(), rng.normal(), rng.normal());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2 * std::atan2(length, w), axis).toRotationMatrix();
  return {mesh, [&](const Vec3& v) { return Vec3(turn * v); }};
}

// By a factor up to a thousand, up or down; log-uniform.
inline FramedMesh randomly_scaled(const Mesh& mesh, Rng rng) {
  const double factor = std::pow(10, 6 * rng.uniform() - 3);
  return {mesh, [&](const Vec3& v) { return Vec3(factor * v); }};
}

// By up to ten R.
inline FramedMesh randomly_shifted(const Mesh& mesh, Rng rng) {
  const double distance = 10 * rng.uniform() * bounding_radius(mesh.vertices);
  const Vec3 shift = distance * random_direction(rng);
  return {mesh, [&](const Vec3& v) { return Vec3(v + shift); }};
}

inline FramedMesh randomly_numbered(const Mesh& mesh, Rng rng) {
  FramedMesh framed(mesh);
  for (std::size_t i = framed.number.size(); i > 1; --i)
    std::swap(framed.number[i - 1], framed.number[rng.below(i)]);
  for (std::size_t i = 0; i < framed.number.size(); ++i)
    framed.mesh.vertices[static_cast<std::size_t>(framed.number[i])] = mesh.vertices[i];
  for (Triangle& face : framed.mesh.faces)
    for (std::int32_t& v : face) v = framed.number[static_cast<std::size_t>(v)];
  return framed;
}

struct RandomFrame {
  std::string_view name;
  FramedMesh (*of)(const Mesh&, Rng);
};
inline constexpr std::array kRandomFrames = {
    RandomFrame{"rotation", randomly_turned}, RandomFrame{"scale", randomly_scaled},
    RandomFrame{"translation", randomly_shifted}, RandomFrame{"order", randomly_numbered}};

}  // namespace salbench
