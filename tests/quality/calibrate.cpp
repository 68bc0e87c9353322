// SPDX-License-Identifier: GPL-3.0-or-later
// How often intervals hold and tests err:  quality_calibrate SCORES.csv [DATA_SETS [MESHES]]
//
// Scores of equal models are simulated with the variances between and within meshes that the scans of a table
// of scores have, as many meshes as it has (or MESHES), and concluded from as a run concludes from its own.
// Where human_curve_by_mesh.csv lies beside the table, meshes with models and people are simulated, too.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "pipeline/results/score_file.h"
#include "tests/quality/calibration.h"
#include "tests/quality/human_calibration.h"

namespace salbench {
namespace {

void print(const std::vector<Rate>& rates, std::size_t data_sets) {
  for (const Rate& rate : rates)
    fmt::print("  {:<38} {:6.2f} %  (nominal {:.0f} %, standard error {:.2f})\n", rate.what,
               100 * rate.value(), 100 * rate.expected,
               100 * std::sqrt(rate.value() * (1 - rate.value()) / static_cast<double>(data_sets)));
}

int run(const std::filesystem::path& path, std::size_t data_sets, std::size_t meshes) {
  const ScoreFile file = read_scores(path);
  for (std::size_t metric = 0; metric < file.metrics.size(); ++metric) {
    ScoreModel model = score_model(file.rows, "scans", metric);
    if (meshes > 0) model.meshes = meshes;
    fmt::print(
        "{}: {} models, {} meshes of {} views; deviations: mesh {:.4f}, view {:.4f}, model by mesh {:.4f}, "
        "by view {:.4f}; {} data sets\n",
        file.metrics[metric].name, model.models, model.meshes, model.views, model.mesh, model.view,
        model.model_of_mesh, model.model_of_view, data_sets);
    print(calibrate(model, data_sets, 2016), data_sets);
    const std::filesystem::path curves = path.parent_path() / "human_curve_by_mesh.csv";
    if (!std::filesystem::exists(curves)) continue;
    const PeopleModel people = people_model(file, curves, metric);
    if (people.models.empty()) continue;
    const std::size_t n = meshes > 0 ? meshes : people.values.units();
    fmt::print("{}: people beside models on {} meshes\n", people.metric.name, n);
    print(calibrate_people(people, n, data_sets, 2016), data_sets);
  }
  return 0;
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    fmt::print(stderr, "usage: quality_calibrate SCORES.csv [DATA_SETS [MESHES]]\n");
    return 2;
  }
  try {
    return salbench::run(argv[1], argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 2000,
                         argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 0);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
