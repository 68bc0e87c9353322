// SPDX-License-Identifier: GPL-3.0-or-later
// From gaze recordings to gaze density on a shape, on arrays.
#include <cmath>
#include <limits>

#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"
#include "stages/gaze/density.h"
#include "stages/gaze/fixations.h"
#include "stages/gaze/hits.h"

namespace salbench::python {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// (start, duration, origin, direction, samples)
py::tuple found_fixations(const FixationOptions& options, py::handle time_of, py::handle directions_of,
                          py::handle origins_of, py::handle valid_of, py::handle places_of) {
  const auto time = field(required(time_of, "time"));
  const auto direction = vectors(required(directions_of, "directions"), time.size());
  std::vector<GazeSample> samples(time.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time = time.values[i];
    samples[i].direction = direction.values[i];
  }
  if (const Argument origins{origins_of, "origins"}; origins.given()) {
    const auto origin = vectors(origins, time.size());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].origin = origin.values[i];
  }
  if (const Argument valid{valid_of, "valid"}; valid.given()) {
    const std::vector<bool> is_valid = mask(valid, time.size());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].valid = is_valid[i];
  }
  if (const Argument places{places_of, "places"}; places.given()) {
    const auto place = vectors(places, time.size());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].place = place.values[i];
  }
  const auto found = computed([&] { return fixations(samples, options); });
  std::vector<double> start, duration;
  std::vector<Vec3> origin, towards;
  std::vector<std::int32_t> counts;
  for (const Fixation& fixation : found) {
    start.push_back(fixation.start);
    duration.push_back(fixation.duration);
    origin.push_back(fixation.origin);
    towards.push_back(fixation.direction);
    counts.push_back(fixation.samples);
  }
  return py::make_tuple(moved(std::move(start)), moved(std::move(duration)), moved(std::move(origin)),
                        moved(std::move(towards)), moved(std::move(counts)));
}

// (face, weights, depth, snapped, place)
py::tuple cast_rays(const HitOptions& options, py::handle points_of, py::handle faces_of,
                    py::handle origins_of, py::handle directions_of, py::handle threads) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  const auto direction = vectors(required(directions_of, "directions"));
  const auto origin = vectors(required(origins_of, "origins"), direction.size());
  std::vector<GazeRay> rays(direction.size());
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = {origin.values[i], direction.values[i]};
  const auto hits =
      computed(thread_count({threads, "threads"}), [&] { return gaze_hits(mesh, rays, options); });
  std::vector<std::int32_t> face;
  std::vector<Vec3> weights, place;
  std::vector<double> distance;
  std::vector<std::uint8_t> snapped;
  for (const GazeHit& hit : hits) {
    place.push_back(hit ? hit.point_in(mesh) : Vec3::Constant(kNaN));
    face.push_back(hit ? static_cast<std::int32_t>(hit.face) : -1);
    weights.push_back(hit.weights);
    distance.push_back(hit ? hit.depth : kNaN);
    snapped.push_back(hit.snapped);
  }
  return py::make_tuple(moved(std::move(face)), moved(std::move(weights)), moved(std::move(distance)),
                        moved(std::move(snapped)).attr("astype")("bool"), moved(std::move(place)));
}

py::array density(const GazeDensityOptions& options, py::handle points_of, py::handle faces_of,
                  py::handle face_of, py::handle weights_of, py::handle depth_of, py::handle mass_of,
                  py::handle origins_of) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  const auto weights = vectors(required(weights_of, "weights"));
  const auto face = field(required(face_of, "face"), weights.size());
  std::vector<LookedAt> fixations(weights.size());
  for (std::size_t i = 0; i < fixations.size(); ++i) {
    const double number = face.values[i];
    if (number != std::floor(number) || number < -1 || number >= static_cast<double>(mesh.faces.size()))
      Argument{face_of, "face"}.fail("must have numbers of faces, or -1 where none was hit");
    fixations[i].hit = {number < 0 ? kNoFace : static_cast<std::uint32_t>(number), weights.values[i], kNaN};
    fixations[i].eye = Vec3::Constant(kNaN);
  }
  if (const Argument origins{origins_of, "origins"}; origins.given()) {
    const auto origin = vectors(origins, weights.size());
    for (std::size_t i = 0; i < fixations.size(); ++i) fixations[i].eye = origin.values[i];
  }
  if (const Argument distances{depth_of, "depth"}; distances.given()) {
    const auto from_eye = field(distances, weights.size());
    for (std::size_t i = 0; i < fixations.size(); ++i) fixations[i].hit.depth = from_eye.values[i];
  }
  if (const Argument mass{mass_of, "mass"}; mass.given()) {
    const auto masses = field(mass, weights.size());
    for (std::size_t i = 0; i < fixations.size(); ++i) fixations[i].mass = masses.values[i];
  }
  return moved(computed([&] { return gaze_density(mesh, fixations, options); }));
}

}  // namespace

void bind_gaze(py::module_& module) {
  define(module, "fixations", &found_fixations);
  define(module, "cast_rays", &cast_rays);
  define(module, "gaze_density", &density);
}

}  // namespace salbench::python
