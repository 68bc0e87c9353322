// SPDX-License-Identifier: GPL-3.0-or-later
// Analytic shapes with known answers.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench::shapes {

inline Mesh tetrahedron() {
  return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

// The surface of [0, 1]^3.
inline Mesh box() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// Divides each face into four, on the same surface; the vertices of the mesh come first.
inline Mesh split_in_four(const Mesh& mesh) {
  Mesh fine{mesh.vertices, {}};
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [entry, fresh] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(fine.vertices.size()));
    if (fresh) fine.vertices.emplace_back((mesh.vertices[index(a)] + mesh.vertices[index(b)]) / 2);
    return entry->second;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.faces.insert(fine.faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

// Unit icosahedron, each face split into four `levels` times, on the unit sphere: 10 * 4^levels + 2 vertices.
inline Mesh sphere(int levels) {
  const double c = 0.850650808352040, d = 0.525731112119134;
  Mesh mesh{{{-d, c, 0},
             {d, c, 0},
             {-d, -c, 0},
             {d, -c, 0},
             {0, -d, c},
             {0, d, c},
             {0, -d, -c},
             {0, d, -c},
             {c, 0, -d},
             {c, 0, d},
             {-c, 0, -d},
             {-c, 0, d}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int level = 0; level < levels; ++level) {
    const std::size_t before = mesh.vertices.size();
    mesh = split_in_four(mesh);
    for (std::size_t i = before; i < mesh.vertices.size(); ++i) mesh.vertices[i].normalize();
  }
  return mesh;
}

// Flat square in z = 0 over [0, 1]^2 with (cells + 1)^2 vertices, normals towards +z.
inline Mesh grid(int cells) {
  Mesh mesh;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x)
      mesh.vertices.emplace_back(static_cast<double>(x) / cells, static_cast<double>(y) / cells, 0);
  const int row = cells + 1;
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const int i = y * row + x;
      mesh.faces.push_back({i, i + 1, i + row + 1});
      mesh.faces.push_back({i, i + row + 1, i + row});
    }
  }
  return mesh;
}

// Both meshes in one, the second moved by `offset`.
inline Mesh joined(Mesh a, const Mesh& b, const Vec3& offset = Vec3::Zero()) {
  const auto n = static_cast<std::int32_t>(a.vertices.size());
  for (const Vec3& v : b.vertices) a.vertices.push_back(v + offset);
  for (const auto& [i, j, k] : b.faces) a.faces.push_back({i + n, j + n, k + n});
  return a;
}

// A sphere with sinusoidal bumps: closed, smooth, without a symmetry that could hide errors.
inline Mesh bumpy_sphere(int levels, double height = 0.2) {
  Mesh mesh = sphere(levels);
  for (Vec3& v : mesh.vertices) {
    v *= 1 + height * std::sin(5 * v.x() + 0.3) * std::sin(4 * v.y() + 1.1) * std::cos(3 * v.z());
  }
  return mesh;
}

inline std::vector<Vec3> random_cloud(std::size_t n, std::uint64_t seed) {
  Rng rng(seed, "cloud", "");
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = {rng.uniform(), rng.uniform(), rng.uniform()};
  return points;
}

inline std::vector<Vec3> random_normals(std::size_t n, std::uint64_t seed) {
  Rng rng(seed, "normals", "");
  std::vector<Vec3> normals(n);
  for (Vec3& p : normals) p = Vec3(rng.normal(), rng.normal(), rng.normal()).normalized();
  return normals;
}

}  // namespace salbench::shapes
