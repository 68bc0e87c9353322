// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/ground_truth.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/parallel.h"
#include "stages/core/seen.h"
#include "stages/geometry/first_hit.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

std::vector<std::vector<LookedAt>> fixations_by_person(const GazeHits& hits, GazeMass mass) {
  std::vector<std::vector<LookedAt>> by_person(hits.people.names.size());
  for (std::size_t i = 0; i < hits.face.size(); ++i)
    if (hits.face[i] >= 0)
      by_person[index(hits.person[i])].push_back(
          {{static_cast<std::uint32_t>(hits.face[i]), hits.weights[i], hits.depth[i]},
           mass == GazeMass::duration ? hits.duration[i] : 1,
           hits.eyes.empty() ? Vec3(kUnseen, kUnseen, kUnseen) : hits.eyes[i]});
  return by_person;
}

double mass_of(std::span<const LookedAt> fixations) {
  return std::accumulate(fixations.begin(), fixations.end(), 0.0,
                         [](double sum, const LookedAt& one) { return sum + one.mass; });
}

// Included people who looked at the shape, with the masses of their fixations and their gaze densities.
struct Lookers {
  std::vector<std::size_t> people = {};
  std::vector<double> masses = {};
  std::vector<ScalarField> densities = {};  // one per person
};

void require_looker(const Lookers& lookers, const GazeHits& hits, const GazeTruthOptions& options) {
  if (!lookers.people.empty()) return;
  const std::vector<std::string> left_out = left_out_people(hits.people, options.people);
  if (std::ranges::none_of(left_out, &std::string::empty))
    throw ShapeError(remark_on_left_out(hits.people, options.people) +
                     ": to take them all the same, write gaze: {most_lost: 1, least_seconds: 0}");
  if (hits.face.empty())
    throw ShapeError("nobody has a fixation: all samples are lost, or all looks are too short");
  if (std::ranges::any_of(hits.face, [](std::int32_t face) { return face >= 0; }))
    throw ShapeError("all fixations on the shape last 0 ms: give them durations, or write gaze: {mass: one}");
  throw ShapeError(
      fmt::format("none of {} fixations of {} people is on the shape: compare frame and unit "
                  "of the recording with those of the shape",
                  hits.face.size(), hits.people.names.size()));
}

Lookers lookers_at(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                   const GazeTruthOptions& options) {
  GazeDensity density(mesh, options.density);
  const std::vector<std::string> left_out = left_out_people(hits.people, options.people);
  const auto fixations = fixations_by_person(hits, options.mass);
  Lookers lookers;
  for (std::size_t p = 0; p < fixations.size(); ++p) {
    const double mass = mass_of(fixations[p]);
    if (!(mass > 0) || !left_out[p].empty()) continue;
    lookers.people.push_back(p);
    lookers.masses.push_back(mass);
    ScalarField& own = lookers.densities.emplace_back(density.of(fixations[p]));
    if (options.weight == GazeWeight::mass && visible == nullptr)
      for (double& value : own) value *= mass;
    if (visible == nullptr) continue;
    const float* const shares = visible->shares.data() + p * visible->n;
    for (std::size_t v = 0; v < own.size(); ++v) own[v] = shares[v] > 0 ? own[v] / shares[v] : kUnseen;
  }
  require_looker(lookers, hits, options);
  return lookers;
}

// Mass per visible mass at each vertex, times the mean mass of the people.
ScalarField per_visible_mass(const Lookers& lookers, const VisibleShares& visible) {
  const double all = std::accumulate(lookers.masses.begin(), lookers.masses.end(), 0.0);
  ScalarField mean(visible.n, kUnseen);
  for (std::size_t v = 0; v < visible.n; ++v) {
    double looked = 0, seen = 0;
    for (std::size_t i = 0; i < lookers.people.size(); ++i) {
      const double mass = lookers.masses[i] * visible.shares[lookers.people[i] * visible.n + v];
      if (!(mass > 0)) continue;
      looked += mass * lookers.densities[i][v];
      seen += mass;
    }
    if (seen > 0) mean[v] = looked / seen * all / static_cast<double>(lookers.people.size());
  }
  return mean;
}

ScalarField mean_of(const Lookers& lookers, const VisibleShares* visible, GazeWeight weight) {
  if (visible != nullptr && weight == GazeWeight::mass) return per_visible_mass(lookers, *visible);
  std::vector<std::size_t> everybody(lookers.people.size());
  std::iota(everybody.begin(), everybody.end(), std::size_t{0});
  return mean_of_seen(lookers.densities, everybody);
}

std::int32_t nearest_corner(const Mesh& mesh, const GazeHits& hits, std::size_t i) {
  const auto face = static_cast<std::uint32_t>(hits.face[i]);
  const Vec3 place = FirstHit{face, hits.weights[i], hits.depth[i]}.point_in(mesh);
  return std::ranges::min(mesh.faces[face], {}, [&](std::int32_t corner) {
    return (mesh.vertices[index(corner)] - place).squaredNorm();
  });
}

// Representative positions of an eye, with the time spent at each.
struct EyePlace {
  Vec3 place;
  double time;
};
std::vector<EyePlace> places_of_eye(const GazeFixations& fixations, std::size_t person, const Vec3& centre) {
  constexpr double kSame = 0.01;
  std::vector<EyePlace> places;
  for (std::size_t i = 0; i < fixations.person.size(); ++i) {
    if (index(fixations.person[i]) != person) continue;
    const Vec3& eye = fixations.origins[i];
    const auto known = std::ranges::find_if(places, [&](const EyePlace& other) {
      return (other.place - eye).norm() <= kSame * (other.place - centre).norm();
    });
    if (known != places.end())
      known->time += fixations.duration[i];
    else
      places.push_back({eye, fixations.duration[i]});
  }
  return places;
}

}  // namespace

VisibleShares visible_shares(const Mesh& mesh, const GazeFixations& fixations) {
  if (fixations.origins.empty() && !fixations.person.empty())
    throw ShapeError(
        "which vertices could be seen is not known: the recording has no place of the eye; "
        "write gaze: {visible: ignored}");
  const std::size_t n = mesh.vertices.size();
  const TracedMesh traced(mesh);
  const Vec3 centre = centroid(mesh.vertices);
  const double near = 1e-6 * bounding_radius(mesh.vertices);
  VisibleShares visible{.n = n, .shares = std::vector<float>(fixations.people.names.size() * n, 0)};
  for (std::size_t person = 0; person < fixations.people.names.size(); ++person) {
    const std::vector<EyePlace> places = places_of_eye(fixations, person, centre);
    const double all = std::accumulate(places.begin(), places.end(), 0.0,
                                       [](double sum, const EyePlace& one) { return sum + one.time; });
    if (!(all > 0)) continue;
    float* const shares = visible.shares.data() + person * n;
    parallel_ranges(n, kPointGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) {
        double time = 0;
        for (const auto& [place, spent] : places) {
          const Vec3 way = mesh.vertices[v] - place;
          const double distance = way.norm();
          if (!(distance > near) || traced.first_hit(place, way / distance).depth >= distance - near)
            time += spent;
        }
        shares[v] = static_cast<float>(time / all);
      }
    });
  }
  return visible;
}

GroundTruth gaze_ground_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                              const GazeTruthOptions& options) {
  Lookers lookers = lookers_at(mesh, hits, visible, options);
  GroundTruth truth;
  truth.saliency = mean_of(lookers, visible, options.weight);
  truth.viewers = std::move(lookers.densities);
  if (options.picks == GazePicks::none) return truth;
  for (const std::size_t person : lookers.people) {
    std::vector<std::int32_t>& picks = truth.picks.emplace_back();
    for (std::size_t i = 0; i < hits.face.size(); ++i)
      if (hits.face[i] >= 0 && index(hits.person[i]) == person)
        picks.push_back(nearest_corner(mesh, hits, i));
  }
  return truth;
}

GroundTruth gaze_face_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                            const GazeTruthOptions& options) {
  const ScalarField of_vertices = mean_of(lookers_at(mesh, hits, visible, options), visible, options.weight);
  GroundTruth truth;
  for (const Triangle& face : mesh.faces) {
    double sum = 0;
    for (const std::int32_t corner : face) sum += of_vertices[index(corner)];
    truth.saliency.push_back(sum / 3);
  }
  return truth;
}

}  // namespace salbench
