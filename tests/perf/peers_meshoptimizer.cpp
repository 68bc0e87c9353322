// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <meshoptimizer.h>

#include "tests/perf/peers.h"

namespace salbench::peers {

Work meshoptimizer_simplified(const Shape& shape, std::size_t faces) {
  std::vector<float> vertices;
  for (const Vec3& p : shape.mesh.vertices)
    for (const double x : p) vertices.push_back(static_cast<float>(x));
  std::vector<unsigned int> corners;
  for (const Triangle& face : shape.mesh.faces)
    for (const std::int32_t v : face) corners.push_back(static_cast<unsigned int>(v));
  return [vertices = std::move(vertices), corners = std::move(corners), faces] {
    constexpr float kAnyError = 1;  // of the mesh's extent
    std::vector<unsigned int> coarse(corners.size());
    coarse.resize(meshopt_simplify(coarse.data(), corners.data(), corners.size(), vertices.data(),
                                   vertices.size() / 3, 3 * sizeof(float), 3 * faces, kAnyError, 0, nullptr));
    benchmark::DoNotOptimize(coarse.data());
    return coarse.size() / 3;
  };
}

}  // namespace salbench::peers
