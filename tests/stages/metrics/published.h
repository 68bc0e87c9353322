// SPDX-License-Identifier: GPL-3.0-or-later
// The authors' published figures, and the ground truth behind them, for tests that compare with them.
// `folder` is that of real_data() in tests/support/data.h.
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "io/table.h"
#include "stages/core/field.h"
#include "stages/core/types.h"
#include "stages/matching/matching.h"
#include "stages/metrics/moments.h"
#include "stages/metrics/roc.h"
#include "tests/support/columns.h"

namespace salbench::published {

using std::filesystem::path;

// Meshes with available human ground truth.
inline constexpr std::array kMeshes{9,   47,  52,  58,  74,  114, 124, 125, 185, 200,
                                    214, 237, 257, 260, 309, 341, 353, 367, 386};

// Positives are the picked points, negatives all others.
inline double auc_exact(const ScalarField& map, const std::vector<std::int32_t>& picked) {
  const ScalarField positives = pick_counts(picked, map.size());
  return mann_whitney(map, ascending_order(map), positives, all_others(positives));
}

inline std::vector<double> numbers(const path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot open " + file.string());
  std::vector<double> values;
  for (double value = 0; in >> value;) values.push_back(value);
  return values;
}

inline GroundTruth ground_truth(const path& folder, int mesh) {
  const path root = folder / "SchellingData";
  const std::string name = std::to_string(mesh);
  GroundTruth truth;
  truth.saliency = numbers(root / "Distributions" / (name + ".val"));
  for (int k = 0; k < 100; ++k) {
    const path file = root / "RawData" / (name + "_" + std::to_string(k) + ".pid");
    if (!std::filesystem::exists(file)) continue;
    auto& picks = truth.picks.emplace_back();
    for (const double vertex : numbers(file)) picks.push_back(static_cast<std::int32_t>(vertex));
  }
  return truth;
}

// Mean histogram of the ground truth of all 400 meshes.
inline Histogram reference_histogram(const path& folder) {
  const Table table = read_csv(folder / "reference" / "mean_histograms_meshes.csv");
  Histogram histogram{};
  std::ranges::copy(number_column(table, "GS"), histogram.begin());
  return histogram;
}

struct PublishedScores {
  double auc, nss, cc;
};

// NaN where there are none.
inline PublishedScores scores(const path& folder, int mesh, const std::string& model) {
  const Table table = read_csv(folder / "reference" / "published_scores.csv");
  const auto item = text_column(table, "item"), models = text_column(table, "model");
  const auto auc = number_column(table, "auc"), nss = number_column(table, "nss"),
             cc = number_column(table, "cc");
  for (std::size_t row = 0; row < item.size(); ++row)
    if (item[row] == std::to_string(mesh) && models[row] == model) return {auc[row], nss[row], cc[row]};
  return {std::nan(""), std::nan(""), std::nan("")};
}

// Mean distance to the published scores over the meshes that have them, for maps matched to the published
// reference.
struct MeanErrors {
  double nss = 0, cc = 0;
  int meshes = 0;
};

template <class MapOf>
MeanErrors mean_errors(const path& folder, const std::string& model, const MapOf& map_of) {
  const Histogram histogram = reference_histogram(folder);
  MeanErrors errors;
  for (const int mesh : kMeshes) {
    const PublishedScores expected = scores(folder, mesh, model);
    if (std::isnan(expected.nss)) continue;
    const GroundTruth truth = ground_truth(folder, mesh);
    const ScalarField map = matched(map_of(folder, mesh), histogram);
    errors.nss += std::abs(nss(map, picked_points(truth)) - expected.nss);
    errors.cc += std::abs(cc(map, min_max_normalised(truth.saliency)) - expected.cc);
    ++errors.meshes;
  }
  errors.nss /= errors.meshes;
  errors.cc /= errors.meshes;
  return errors;
}

// Pearson correlation with a map extracted from the paper's figure, over the vertices that it shows.
inline double correlation_with_figure(const path& folder, const std::string& model, int mesh,
                                      const ScalarField& map) {
  const auto figure =
      numbers(folder / "reference" / "figures" / (model + "_" + std::to_string(mesh) + ".txt"));
  ScalarField ours, theirs;
  for (std::size_t i = 0; i + 1 < figure.size(); i += 2) {
    ours.push_back(map.at(static_cast<std::size_t>(figure[i])));
    theirs.push_back(figure[i + 1]);
  }
  return cc(ours, theirs);
}

}  // namespace salbench::published
