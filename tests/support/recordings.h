// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated recordings of people who look at a shape from around it.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "stages/core/gaze.h"
#include "stages/core/rng.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

// Each person rests for 250 ms each on `rests` vertices, at 60 samples a second, from a position three
// bounding radii away.
inline GazeRecording toy_recording(const Mesh& mesh, std::int32_t people, int rests = 6,
                                   std::uint64_t seed = 1) {
  GazeRecording recording;
  const Vec3 centre = centroid(mesh.vertices);
  const double far = 3 * bounding_radius(mesh.vertices);
  Rng rng(seed, "recording", "toy");
  for (std::int32_t person = 0; person < people; ++person) {
    recording.people.push_back("P" + std::to_string(person + 1));
    const double around = 2 * std::numbers::pi * person / people;
    const Vec3 eye = centre + far * Vec3(std::cos(around), std::sin(around), 0.3);
    int sample = 0;
    for (int rest = 0; rest < rests; ++rest) {
      const Vec3& place = mesh.vertices[rng.below(mesh.vertices.size())];
      for (int k = 0; k < 15; ++k, ++sample) {
        recording.person.push_back(person);
        recording.time.push_back(sample * 1000.0 / 60);
        recording.valid.push_back(1);
        recording.origins.push_back(eye);
        recording.directions.push_back((place - eye).normalized());
      }
    }
  }
  return recording;
}

}  // namespace salbench
