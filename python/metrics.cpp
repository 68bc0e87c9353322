// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics and histogram matching on arrays (stages/metrics, stages/matching).
#include "stages/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>

#include "pipeline/rules/scoring.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/centre.h"
#include "stages/matching/matching.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"
#include "stages/metrics/surface_graph.h"

namespace salbench::python {
namespace {

// The numeric options of the metrics: names and matching are separate arguments.
struct ScoreOptions : MetricsOptions {
  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    MetricsOptions::fields(self,
                           [&]<class Value>(std::string_view key, Value& value, const OptionHelp& help) {
                             if constexpr (std::is_arithmetic_v<std::remove_const_t<Value>>)
                               visit(key, value, help);
                           });
  }
};

bool are_all(const std::vector<std::string>& names) { return names.size() == 1 && names[0] == kEveryName; }

// Names of metrics from one or several names, or all of them; KeyError for an unknown name.
std::vector<std::string> names_from(py::handle metrics) {
  std::vector<std::string> names;
  if (py::isinstance<py::str>(metrics)) {
    names.push_back(std::string(py::str(metrics)));
  } else {
    if (!py::hasattr(metrics, "__iter__"))
      throw py::value_error("metrics must be a name, or a sequence of names");
    for (const py::handle name : metrics) names.push_back(py::str(name));
  }
  if (!are_all(names))
    for (const std::string& name : names) row_named("metric", name, metric_table(), &Metric::name);
  return names;
}

// Ground truth for comparison. Points outside of the mask count as unseen.
struct Truth {
  GroundTruth values;
  std::optional<std::vector<std::int32_t>> seen;  // set if the saliency does not show it
};

Truth truth_from(const Argument& ground_truth, const Argument& picked, const Argument& masked,
                 std::size_t n) {
  Truth truth;
  if (ground_truth.given()) truth.values.saliency = field(ground_truth, n).copy();
  truth.values.picks = picks(picked, n);
  if (!masked.given()) return truth;
  const std::vector<bool> counts = mask(masked, n);
  for (std::size_t i = 0; i < n; ++i)
    if (ground_truth.given() && !counts[i])
      truth.values.saliency[i] = std::numeric_limits<double>::quiet_NaN();
  if (ground_truth.given()) return truth;
  truth.seen.emplace();
  for (std::size_t i = 0; i < n; ++i)
    if (counts[i]) truth.seen->push_back(static_cast<std::int32_t>(i));
  truth.values = truth_at(truth.values, *truth.seen);
  return truth;
}

// A tuple is (number, model, item), as in 1.0, where draws depended on the model's name.
RandomSource random_from(py::handle seed) {
  if (!py::isinstance<py::tuple>(seed)) return {whole_number({seed, "seed"}, 0, UINT64_MAX)};
  const auto parts = seed.cast<py::tuple>();
  if (parts.size() != 2 && parts.size() != 3)
    throw py::value_error("seed must be a number, or (number, item)");
  return {whole_number({py::object(parts[0]), "seed"}, 0, UINT64_MAX), py::str(parts[parts.size() - 1])};
}

struct ShapeArrays {
  View<double> areas, negatives;
  View<Vec3> points;
  std::vector<Triangle> faces;
};

// Missing inputs are no error: metrics that need them are undefined.
Measures measures_from(std::span<const Metric> metrics, std::size_t n, const ShapeArrays& shape) {
  const Points points = shape.points.values;
  Measures measures{.size = n, .areas = shape.areas.copy(), .negatives = shape.negatives.copy()};
  if (!points.empty() && any_reads(metrics, Reads::positions))
    measures.centre_bias = distances_from_centroid(points);
  if (!points.empty() && !shape.faces.empty() && any_reads(metrics, Reads::surface_distances))
    measures.surface = std::make_shared<const SurfaceGraph>(surface_graph(points, shape.faces));
  return measures;
}

// Scores of each prediction: [metric].
std::vector<Scores> scored(const View<double>& predictions, std::size_t n, const Truth& truth,
                           const std::optional<Histogram>& reference, const MetricsOptions& options,
                           const RandomSource& random, const ShapeArrays& shape) {
  const MetricsByMatching metrics(options);
  const Rng draws = draws_of_scores(random);
  const Measures of_shape = measures_from(metrics.all(), n, shape);
  const Measures measures = truth.seen ? of_shape.at(*truth.seen) : of_shape;
  std::vector<Scores> all;
  for (std::size_t first = 0; first < predictions.size(); first += n) {
    const auto map = predictions.values.subspan(first, n);
    require_finite(map, "prediction");
    all.push_back(
        in_range(metrics.all(), metrics.score([&](std::span<const Metric> part, Matching matching) -> Scores {
          const bool match = matching == Matching::histogram && reference;
          ScalarField read = match ? matched(map, *reference) : unmatched(map, matching);
          if (truth.seen) read = values_at(read, *truth.seen);
          return score(part, read, truth.values, options, draws, measures);
        })));
  }
  return all;
}

// n weights >= 0.
View<double> weights(const Argument& argument, std::size_t n) {
  const auto values = argument.given() ? field(argument, n) : View<double>{};
  if (!std::ranges::all_of(values.values, [](double weight) { return weight >= 0 && weight < HUGE_VAL; }))
    argument.fail("must be finite and >= 0");
  return values;
}

py::dict score_arrays(const ScoreOptions& numbers, py::handle prediction, py::handle ground_truth,
                      py::handle picked, py::handle areas, py::handle points_of, py::handle faces_of,
                      py::handle negatives, py::handle masked, py::handle metrics, py::handle reference,
                      py::handle seed) {
  MetricsOptions options = numbers;
  options.names = names_from(metrics);
  if (are_all(options.names)) {
    options.names.clear();
    for (const Metric& metric : metric_table()) options.names.push_back(metric.name);
  }
  const View<double> predictions = rows({prediction, "prediction"}, {{ground_truth, "ground_truth"},
                                                                     {masked, "mask"},
                                                                     {areas, "areas"},
                                                                     {negatives, "negatives"},
                                                                     {points_of, "points"}});
  const bool several = predictions.array.ndim() == 2;
  const auto n = static_cast<std::size_t>(predictions.array.shape(several ? 1 : 0));
  if (n == 0) throw py::value_error("prediction must have at least one point");
  const Truth truth = truth_from({ground_truth, "ground_truth"}, {picked, "picks"}, {masked, "mask"}, n);
  const Argument places{points_of, "points"};
  const View<Vec3> place_of = places.given() ? points(places, n) : View<Vec3>{};
  const Argument corners{faces_of, "faces"};
  const ShapeArrays shape{weights({areas, "areas"}, n), weights({negatives, "negatives"}, n), place_of,
                          faces(corners, n)};
  const auto densities = histogram({reference, "reference"});
  const RandomSource random = random_from(seed);
  const std::vector<Scores> all =
      computed([&] { return scored(predictions, n, truth, densities, options, random, shape); });
  py::dict result;
  const auto chosen = chosen_metrics(options);
  for (std::size_t m = 0; m < chosen.size(); ++m) {
    std::vector<double> column;
    for (const Scores& scores : all) column.push_back(scores.values[m]);
    if (several)
      result[py::str(chosen[m].name)] = moved(std::move(column));
    else
      result[py::str(chosen[m].name)] = py::float_(column[0]);
  }
  return result;
}

py::list metric_rows() {
  py::list rows;
  for (const Metric& metric : metric_table())
    rows.append(py::make_tuple(metric.name, metric.unit, metric.help, metric.higher_is_better, metric.label,
                               metric.range.low, metric.range.high));
  return rows;
}

}  // namespace

void bind_metrics(py::module_& module) {
  define(module, "score", &score_arrays);
  module.def("metric_rows", &metric_rows);
  module.def("match_histogram", [](py::handle values, py::handle reference) {
    const auto map = field({values, "values"});
    const auto densities = histogram(required(reference, "reference"));
    return moved(computed([&] { return matched(map.values, *densities); }));
  });
  module.def("histogram", [](py::handle values) {
    const auto map = field({values, "values"});
    ScalarField seen;
    std::ranges::copy_if(map.values, std::back_inserter(seen), [](double x) { return !std::isnan(x); });
    if (seen.empty()) throw py::value_error("values must have at least one that is not NaN");
    const Histogram bins = computed([&] { return normalised_histogram(seen); });
    return moved(std::vector<double>(bins.begin(), bins.end()));
  });
}

}  // namespace salbench::python
