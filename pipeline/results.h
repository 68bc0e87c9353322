// Results of a run, item by item, and the files they are written to.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/config.h"
#include "pipeline/plan.h"
#include "pipeline/runner.h"
#include "stages/core/types.h"

namespace salbench {

inline constexpr const char* kSimulatedNote =
    "SIMULATED participants: the ground truth was made by the program; these scores say nothing about "
    "people.";

struct ResultRow {
  std::string dataset;  // "meshes" or "scans"
  std::string item;     // the mesh
  std::string category;
  std::string view;  // of a scan; empty for a mesh
  std::string model;
  Scores scores;
};

struct DatasetAndModel {
  std::string dataset, model;
  bool operator==(const DatasetAndModel&) const = default;
};

// Those that the rows speak of: meshes before scans, models in the order of their first row.
std::vector<DatasetAndModel> datasets_and_models(const std::vector<ResultRow>& rows);

// One row per item and model that was scored; by item, mesh before scans, then in the order of the models.
std::vector<ResultRow> collect_results(const Config& config, const Context& context, const Plan& plan,
                                       Runner& runner);

// Human curves of the meshes that HS was computed for, in their order.
std::vector<HumanCurve> collect_human_curves(const Config& config, const Context& context, const Plan& plan,
                                             Runner& runner);

Table results_table(const std::vector<ResultRow>& rows);

// dataset, model, metric, n, mean, sd, 95 % confidence interval of the mean; undefined scores are left out of
// n.
Table summary_table(const std::vector<ResultRow>& rows);

// A density over 100 bins from the column GS of a CSV file; what sums to something else is scaled, with a
// warning. Throws InputError or ConfigError, with file and line.
Histogram read_reference(const std::string& path);

// Makes the folder of a run's results, and tells in it that one is under way. Throws StorageError.
void prepare_output(const std::filesystem::path& folder);

// Record of a run: configuration, versions, timings, failures.
struct RunRecord {
  const Config& config;
  const Context& context;
  const Plan& plan;
  Runner& runner;
  int threads = 1;
  double seconds = 0;
  Why why = {};  // of what was computed; empty: not recorded
};

// Writes the record of a run over a share, such as shard_2_of_4.yaml.
void write_shard_record(const std::filesystem::path& folder, const RunRecord& record);

// results.csv, summary.csv, per_class.csv, significance.csv, mean_histograms_{meshes,scans}.csv and run.yaml;
// where HS was computed, human_curve.csv.
void write_results(const std::filesystem::path& folder, const RunRecord& record,
                   const std::vector<ResultRow>& rows);

}  // namespace salbench
