// SPDX-License-Identifier: GPL-3.0-or-later
// Input that no shape should be, for every model: rejected as such, or a map of finite values. Further
// behaviour of a model is in its own test.

#include "tests/support/mesh_models.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Mesh with_vertex(const Vec3& v) {
  Mesh mesh = shapes::sphere(2);
  mesh.vertices[3] = v;
  return mesh;
}

Mesh with_face(const Triangle& face) {
  Mesh mesh = shapes::bumpy_sphere(2);
  mesh.faces.push_back(face);
  return mesh;
}

Mesh placed(Mesh mesh, double scale, const Vec3& at) {
  for (Vec3& v : mesh.vertices) v = scale * v + at;
  return mesh;
}

// A hole, an edge of three faces, a face without area, a vertex without a face.
Mesh torn() {
  Mesh mesh = shapes::bumpy_sphere(3);
  mesh.faces.erase(mesh.faces.begin() + 100, mesh.faces.begin() + 140);
  mesh.vertices.emplace_back(0.2, 0.1, 0);
  mesh.faces.push_back({5, 300, static_cast<std::int32_t>(mesh.vertices.size()) - 1});
  mesh.faces.push_back({7, 7, 8});
  mesh.vertices.emplace_back(3, 3, 3);
  return mesh;
}

std::string outcome(const MeshModel& model, const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const DescribedMesh described(mesh, Normals(n, Vec3::UnitZ()), {std::vector<float>(n * kFpfhBins)});
  try {
    const ScalarField map = model.map(described);
    if (map.size() != n || !std::ranges::all_of(map, [](double value) { return std::isfinite(value); }))
      return "no map";
    return std::ranges::all_of(map, [](double value) { return value == 0; }) ? "zero" : "finite";
  } catch (const InputError&) {
    return "refused";
  }
}

// Results of models that read no faces, on shapes without faces.
const std::map<std::string_view, std::string_view> kWithoutFaces = {
    {"LS", "zero"}, {"CS", "finite"}, {"PS", "zero"}, {"CB", "finite"}, {"NV", "zero"}};

struct Degenerate {
  std::string_view name;
  Mesh mesh;
  std::string_view of_most;  // models
  std::map<std::string_view, std::string_view>
      other;  // by model. PS reads only descriptors, which are 0; VD only faces
};

const std::vector<Degenerate> kInputs = {
    {"no points", {}, "refused", {{"PS", "zero"}, {"MS", "zero"}, {"VD", "zero"}}},
    {"one point",
     {{{1, 2, 3}}, {}},
     "refused",
     {{"CS", "zero"}, {"PS", "zero"}, {"MS", "zero"}, {"VD", "zero"}}},
    {"all points in one place",
     placed(shapes::sphere(2), 0, {1, 2, 3}),
     "refused",
     {{"CS", "zero"}, {"PS", "zero"}, {"MS", "zero"}, {"VD", "finite"}}},
    {"a coordinate that is no number",
     with_vertex({0, kNan, 0}),
     "refused",
     {{"PS", "zero"}, {"VD", "finite"}}},
    {"an infinite coordinate", with_vertex({kInfinity, 0, 0}), "refused", {{"PS", "zero"}, {"VD", "finite"}}},
    {"coordinates that are too large",
     placed(shapes::bumpy_sphere(2), 1e200, Vec3::Zero()),
     "refused",
     {{"PS", "zero"}, {"VD", "finite"}}},
    {"a face beyond the points", with_face({0, 1, 9999}), "refused", kWithoutFaces},
    {"a face below 0", with_face({0, -1, 2}), "refused", kWithoutFaces},
    {"points alone",
     {shapes::random_cloud(100, 1), {}},
     "zero",
     {{"LS", "finite"}, {"CS", "finite"}, {"CB", "finite"}, {"VIS", "finite"}}},
    {"torn", torn(), "finite", {{"PS", "zero"}, {"NV", "zero"}}},
};

TEST(Degenerate, IsRefusedOrHasAFiniteMap) {
  for (const auto& [name, mesh, of_most, other] : kInputs)
    for (const MeshModel& model : kMeshModels) {
      const auto own = other.find(model.name);
      EXPECT_EQ(outcome(model, mesh), own == other.end() ? of_most : own->second)
          << model.name << " of " << name;
    }
}

}  // namespace
}  // namespace salbench
