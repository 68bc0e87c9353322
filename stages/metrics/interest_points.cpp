// SPDX-License-Identifier: GPL-3.0-or-later
// A detected point within the tolerance of a marked one, and not closer to another, is one whose nearest
// marked point this is: one search from all marked points together finds them.
#include "stages/metrics/interest_points.h"

#include <algorithm>
#include <vector>

namespace salbench {
namespace {

// Each once, and how often.
struct Marked {
  std::vector<std::int32_t> points;
  std::vector<double> times;
};

Marked counted(std::span<const std::int32_t> marked) {
  Marked found;
  for (const std::int32_t i : marked) {
    if (found.points.empty() || found.points.back() != i) {
      found.points.push_back(i);
      found.times.push_back(0);
    }
    ++found.times.back();
  }
  return found;
}

double count_reached(std::span<const std::int32_t> points, const std::vector<NearestSource>& nearest) {
  return static_cast<double>(
      std::ranges::count_if(points, [&](std::int32_t i) { return nearest[index(i)].source >= 0; }));
}

}  // namespace

InterestPointScores interest_point_scores(std::span<const std::int32_t> detected,
                                          std::span<const std::int32_t> marked, const SurfaceGraph& graph,
                                          double tolerance) {
  InterestPointScores scores;
  if (marked.empty()) return scores;
  const Marked truth = counted(marked);
  const double reach = tolerance * graph.diameter;
  const auto nearest_marked = nearest_sources(graph, truth.points, reach);
  std::vector<bool> correct(truth.points.size());
  for (const std::int32_t i : detected)
    if (const std::int32_t source = nearest_marked[index(i)].source; source >= 0)
      correct[index(source)] = true;
  double n_correct = 0, times_correct = 0;
  for (std::size_t k = 0; k < correct.size(); ++k) {
    n_correct += correct[k] ? 1 : 0;
    times_correct += correct[k] ? truth.times[k] : 0;
  }
  const auto n_marked = static_cast<double>(truth.points.size());
  scores.fne = 1 - n_correct / n_marked;
  scores.wme = 1 - times_correct / static_cast<double>(marked.size());
  scores.recall = count_reached(truth.points, nearest_sources(graph, detected, reach)) / n_marked;
  const double n_detected = std::max(1.0, static_cast<double>(detected.size()));
  scores.fpe = 1 - n_correct / n_detected;
  scores.precision = count_reached(detected, nearest_marked) / n_detected;
  return scores;
}

}  // namespace salbench
