// SPDX-License-Identifier: GPL-3.0-or-later
// Random cases with the values of every metric, for metrics_reference.py: one JSON object per line.
//   metric_cases SEED COUNT
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "stages/metrics/score.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {
namespace {

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text;
  for (const auto number : numbers) text += fmt::format("{}{}", text.empty() ? "" : ", ", number);
  return "[" + text + "]";
}

struct Case {
  ScalarField map, areas, centre_bias;
  GroundTruth truth;
  ScalarField negatives = {};
  Mesh mesh = {};
};

// Random positions, a strip of faces over most points, and some random faces.
Mesh random_mesh(std::size_t n, Rng& rng) {
  Mesh mesh;
  for (std::size_t i = 0; i < n; ++i) mesh.vertices.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  const auto point = [](std::size_t i) { return static_cast<std::int32_t>(i); };
  for (std::size_t i = 0; i + 2 < n; ++i)
    if (rng.below(5) > 0) mesh.faces.push_back({point(i), point(i + 1), point(i + 2)});
  for (std::uint64_t k = rng.below(4); k > 0; --k)
    mesh.faces.push_back({point(rng.below(n)), point(rng.below(n)), point(rng.below(n))});
  return mesh;
}

// Maps and ground truths with few levels, so that values tie, with zeros, and constant ones; areas of zero;
// no pick, one, or up to all points.
Case random_case(Rng& rng) {
  const std::size_t n = 2 + rng.below(60);
  const auto field = [&] {
    const double levels = rng.below(4) == 0 ? static_cast<double>(1 + rng.below(4)) : 1e6;
    const double zeros = rng.below(2) == 0 ? 0 : rng.uniform();
    const bool constant = rng.below(20) == 0;
    const double value = rng.below(2) == 0 ? 0 : rng.uniform();
    ScalarField values(n);
    for (double& v : values) v = rng.uniform() < zeros ? 0 : std::round(rng.uniform() * levels) / levels;
    return constant ? ScalarField(n, value) : values;
  };
  Case random{field(), {}, {}, {field(), {}, false}};
  for (std::size_t i = 0; i < n; ++i) random.areas.push_back(rng.below(10) == 0 ? 0 : 0.01 + rng.uniform());
  const std::size_t participants = rng.below(4);
  for (std::size_t k = 0; k < participants; ++k) {
    auto& picks = random.truth.picks.emplace_back();
    const std::size_t count = rng.below(4) == 0 ? 1 : rng.below(n);
    for (std::size_t pick = 0; pick < count; ++pick) picks.push_back(static_cast<std::int32_t>(rng.below(n)));
  }
  if (rng.below(30) == 0) {
    random.truth.picks.resize(1);
    for (std::size_t i = 0; i < n; ++i) random.truth.picks[0].push_back(static_cast<std::int32_t>(i));
  }
  for (std::size_t i = 0; i < n; ++i) random.centre_bias.push_back(rng.below(10) == 0 ? 0 : rng.uniform());
  for (std::size_t i = 0; i < n; ++i) random.negatives.push_back(rng.below(3) == 0 ? 0 : rng.uniform());
  random.mesh = random_mesh(n, rng);
  return random;
}

void print_case(const Case& random, const std::string& item, const MetricsOptions& options) {
  const Rng draws(1, "scores", item);
  const Measures measures{
      random.map.size(), random.areas, random.centre_bias, random.negatives,
      std::make_shared<const SurfaceGraph>(surface_graph(random.mesh.vertices, random.mesh.faces))};
  const Scores scores = score(metric_table(), random.map, random.truth, options, draws, measures);
  ScalarField points;
  for (const Vec3& p : random.mesh.vertices) points.insert(points.end(), p.begin(), p.end());
  std::vector<std::int32_t> faces;
  for (const Triangle& face : random.mesh.faces) faces.insert(faces.end(), face.begin(), face.end());
  std::vector<std::int32_t> picks;
  for (const auto& participant : random.truth.picks)
    picks.insert(picks.end(), participant.begin(), participant.end());
  std::string values;
  for (std::size_t m = 0; m < scores.values.size(); ++m)
    values += fmt::format("{}\"{}\": {}", m == 0 ? "" : ", ", metric_table()[m].name,
                          std::isnan(scores.values[m]) ? "NaN" : fmt::format("{}", scores.values[m]));
  fmt::print(
      "{{\"item\": \"{}\", \"constant_nss\": {}, \"floor\": {}, "
      "\"peak_radius\": {}, \"peak_height\": {}, \"tolerance\": {}, \"map\": {}, \"negatives\": {}, "
      "\"points\": {}, \"faces\": {}, "
      "\"saliency\": {}, \"areas\": {}, \"centre_bias\": {}, \"picks\": {}, \"values\": {{{}}}}}\n",
      item, options.constant_nss, options.floor, options.peak_radius, options.peak_height, options.tolerance,
      list(random.map), list(random.negatives), list(points), list(faces), list(random.truth.saliency),
      list(random.areas), list(random.centre_bias), list(picks), values);
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: metric_cases SEED COUNT\n";
    return 2;
  }
  salbench::MetricsOptions options;
  options.splits = 3;
  options.constant_nss = -0.25;
  for (int k = 0; k < std::atoi(argv[2]); ++k) {
    salbench::Rng rng(std::strtoull(argv[1], nullptr, 10), "metric cases", std::to_string(k));
    const salbench::Case random = salbench::random_case(rng);
    options.floor = rng.below(2) == 0 ? 0 : rng.uniform() / 10;
    options.peak_radius = rng.below(2) == 0 ? 0 : rng.uniform();
    options.peak_height = rng.below(2) == 0 ? 1 : 1.5 * rng.uniform();
    options.tolerance = rng.below(4) == 0 ? 0.03 : 0.7 * rng.uniform();
    salbench::print_case(random, std::to_string(k), options);
  }
}
