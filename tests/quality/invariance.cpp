// SPDX-License-Identifier: GPL-3.0-or-later
// Sensitivity of scores to position, rotation, scale and vertex numbering of a mesh:
//   quality_invariance DATA [TRIALS]
//
// DATA contains SchellingData/. Every mesh with ground truth is moved to TRIALS random frames of each kind
// (default: 3). The maps of all models that draw no random numbers, with their default options, are matched
// and scored there and in the file's frame. Prints two tables: the scores, and their changes.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "stages/matching/matching.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/correlation.h"
#include "tests/support/mesh_models.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct Marked {
  std::string name;
  Mesh mesh;
  ScalarField saliency;
  std::vector<std::int32_t> picks;  // ascending and distinct
};

std::vector<Marked> marked_meshes(const fs::path& data) {
  std::vector<Marked> all;
  for (const int mesh : published::kMeshes) {
    const GroundTruth truth = published::ground_truth(data, mesh);
    const std::string name = std::to_string(mesh);
    all.push_back({name, read_mesh(data / "SchellingData/Meshes" / (name + ".off")), truth.saliency,
                   picked_points(truth)});
  }
  // Rounding of sums depends on the order of the terms: docs/invariance.md was printed in this one.
  std::ranges::sort(all, [](const Marked& a, const Marked& b) { return a.name < b.name; });
  return all;
}

// --- scores

enum Score : std::size_t { auc_score, nss_score, lcc_score, kScores };
using ScoresOf = std::array<double, kScores>;

ScoresOf scores_of(const ScalarField& map, const Histogram& reference, const Marked& marked) {
  const ScalarField values = matched(map, reference);
  return {published::auc_exact(values, marked.picks), nss(values, marked.picks),
          std::abs(cc(values, marked.saliency))};
}

struct Moved {
  ScoresOf sum{}, largest{};           // absolute differences
  std::vector<ScoresOf> sum_of_trial;  // [trial]: of the differences over the items
  double least_correlation = 1;        // least rank correlation between two maps of an item

  void add(std::size_t trial, const ScoresOf& before, const ScoresOf& after) {
    if (sum_of_trial.size() <= trial) sum_of_trial.resize(trial + 1);
    for (std::size_t s = 0; s < kScores; ++s) {
      const double difference = after[s] - before[s];
      sum[s] += std::abs(difference);
      largest[s] = std::max(largest[s], std::abs(difference));
      sum_of_trial[trial][s] += difference;
    }
  }
  double largest_of_sums(std::size_t score) const {
    double most = 0;
    for (const ScoresOf& of_trial : sum_of_trial) most = std::max(most, std::abs(of_trial[score]));
    return most;
  }
};

struct Findings {
  // Per model.
  std::vector<ScoresOf> sums = std::vector<ScoresOf>(kMeshModels.size());  // in the file's frame
  std::vector<std::array<Moved, kRandomFrames.size()>> moved =
      std::vector<std::array<Moved, kRandomFrames.size()>>(kMeshModels.size());

  void add(const Marked& marked, const Histogram& reference, std::size_t trials) {
    const DescribedMesh shape(marked.mesh);
    std::vector<ScalarField> maps(kMeshModels.size());
    std::vector<ScoresOf> scores(kMeshModels.size());
    for (std::size_t m = 0; m < kMeshModels.size(); ++m) {
      maps[m] = kMeshModels[m].map(shape);
      scores[m] = scores_of(maps[m], reference, marked);
      for (std::size_t s = 0; s < kScores; ++s) sums[m][s] += scores[m][s];
    }
    for (std::size_t kind = 0; kind < kRandomFrames.size(); ++kind)
      for (std::size_t trial = 0; trial < trials; ++trial) {
        const Rng rng(trial, kRandomFrames[kind].name, marked.name);
        const FramedMesh framed = kRandomFrames[kind].of(marked.mesh, rng);
        const DescribedMesh there(framed.mesh);
        for (std::size_t m = 0; m < kMeshModels.size(); ++m) {
          const ScalarField map = framed.in_order_before(kMeshModels[m].map(there));
          Moved& of = moved[m][kind];
          of.add(trial, scores[m], scores_of(map, reference, marked));
          of.least_correlation = std::min(of.least_correlation, spearman(maps[m], map));
        }
      }
  }

  void print(std::size_t items, std::size_t trials) const {
    const auto n = static_cast<double>(items);
    fmt::print("| Model | AUC | NSS | LCC |\n|---|---|---|---|\n");
    for (std::size_t m = 0; m < kMeshModels.size(); ++m)
      fmt::print("| {} | {:.4f} | {:.4f} | {:.4f} |\n", kMeshModels[m].name, sums[m][auc_score] / n,
                 sums[m][nss_score] / n, sums[m][lcc_score] / n);
    fmt::print(
        "\n| Model | Frame | AUC | NSS | LCC | mean AUC | mean NSS | mean LCC | rank correlation |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    for (std::size_t m = 0; m < kMeshModels.size(); ++m)
      for (std::size_t kind = 0; kind < kRandomFrames.size(); ++kind) {
        const Moved& of = moved[m][kind];
        fmt::print("| {} | {} |", kMeshModels[m].name, kRandomFrames[kind].name);
        for (std::size_t s = 0; s < kScores; ++s)
          fmt::print(" {:.1e}, {:.1e} |", of.sum[s] / (n * static_cast<double>(trials)), of.largest[s]);
        for (std::size_t s = 0; s < kScores; ++s) fmt::print(" {:.1e} |", of.largest_of_sums(s) / n);
        fmt::print(" {:.4f} |\n", of.least_correlation);
      }
  }
};

void measure(const fs::path& data, std::size_t trials) {
  const std::vector<Marked> all = marked_meshes(data);
  std::vector<Histogram> histograms;
  for (const Marked& marked : all) histograms.push_back(normalised_histogram(marked.saliency));
  const Histogram reference = mean_histogram(histograms);
  Findings findings;
  for (const Marked& marked : all) findings.add(marked, reference, trials);
  findings.print(all.size(), trials);
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  const std::string given = argc == 3 ? argv[2] : "3";
  std::size_t trials = 0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), trials);
  if (argc < 2 || argc > 3 || error != std::errc() || end != given.data() + given.size() || trials == 0) {
    fmt::print(stderr, "usage: quality_invariance DATA [TRIALS]\n");
    return 2;
  }
  try {
    salbench::measure(argv[1], trials);
  } catch (const std::exception& e) {
    fmt::print(stderr, "quality_invariance: {}\n", e.what());
    return 1;
  }
}
