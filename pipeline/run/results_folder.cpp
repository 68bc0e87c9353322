// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/results_folder.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/digest.h"
#include "io/file.h"
#include "pipeline/config/section.h"
#include "pipeline/results/tables.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConclusions = "conclusions.json";
constexpr std::size_t kHead = 1U << 16U;  // leading part of run.yaml, with remarks before its first key

std::string digest_of(const RunState& run, const std::vector<TableFile>& files) {
  Hasher hasher;
  hasher.add(SALBENCH_VERSION);
  hasher.add(name_of(run.config.statistics.unit));
  if (!run.config.statistics.leading.empty()) hasher.add(run.config.statistics.leading);
  hasher.add(run.config.seed);
  for (const Failure& failure : run.resolver.failures())  // conclusions name models without a map, and why
    if (const Rule& rule = run.project().rule(failure.job); has_role(rule, Role::map)) {
      hasher.add(rule.stage);
      hasher.add(failure.cause);
      hasher.add(run.config.models.size());
    }
  for (const Model& model : run.config.models)  // tables and sentences repeat it
    if (!model.trained.empty()) {
      hasher.add(model.name);
      hasher.add(model.trained);
    }
  for (const TableFile& file : files)
    if (file.is_of_scores && file.text) {
      hasher.add(file.name);
      hasher.add(*file.text);
    }
  return hasher.digest().hex();
}

// True if the conclusions in the folder belong to these scores. Readers check the tables.
bool are_of(const fs::path& conclusions, const std::string& digest) {
  return size_of_file(conclusions) &&
         read_file(conclusions).find(fmt::format("\"of\": \"{}\"", digest)) != std::string::npos;
}

// Every file that a run and its conclusions may have in a folder, except the record.
std::vector<std::string> files_of_scores() {
  std::vector<std::string> files = names_of_tables();
  files.insert(files.end(), files_of_conclusions().begin(), files_of_conclusions().end());
  return files;
}

// A cross-validation takes the seconds of earlier trainings from its table, and writes both tables at its
// end.
void remove_tables_of_folds(const fs::path& folder, const RunState& run) {
  remove_file(folder / kFoldsTable);
  if (std::ranges::all_of(run.config.models, [](const Model& model) { return model.trained.empty(); }))
    remove_file(folder / kTrainingTable);
}

std::string advice() { return "choose another with " + as_option("out"); }

void require_own(const fs::path& folder) {
  if (size_of_file(folder / kRecord)) {
    if (!is_record_text(read_head(folder / kRecord, kHead)))
      throw ConfigError(fmt::format("{}: is no record of a run, and one would take its place; {}",
                                    (folder / kRecord).string(), advice()));
    return;
  }
  for (const std::string& name : files_of_scores())
    if (std::error_code none; fs::exists(folder / name, none))
      throw ConfigError(fmt::format("{}: has {}, and no {}, so it is of no run, which would replace it; {}",
                                    folder.string(), name, kRecord, advice()));
}

}  // namespace

void begin_results(const fs::path& folder, const std::string& record) {
  make_folder(folder, advice());
  require_own(folder);
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / kRecord, record);
}

std::string write_scores(const fs::path& folder, const RunState& run, const std::vector<ResultRow>& rows,
                         const std::vector<std::string>& remarks) {
  const std::vector<TableFile> files = table_files(run, rows, remarks);
  const std::string digest = digest_of(run, files);
  if (!are_of(folder / kConclusions, digest))
    for (const std::string& name : files_of_conclusions()) remove_file(folder / name);
  for (const auto& [name, text, is_of_scores] : files)
    text ? write_file(folder / name, *text) : remove_file(folder / name);
  remove_tables_of_folds(folder, run);
  return digest;
}

void remove_scores(const fs::path& folder, const RunState& run) {
  for (const std::string& name : files_of_scores())
    if (name != kTrainingTable) remove_file(folder / name);
  remove_tables_of_folds(folder, run);
}

const std::vector<std::string>& files_of_conclusions() {
  static const std::vector<std::string> files = {kConclusions,
                                                 "chance.csv",
                                                 "summary.csv",
                                                 "ranking.csv",
                                                 "ranking_agreement.csv",
                                                 "significance.csv",
                                                 "per_class.csv",
                                                 "human_share.csv",
                                                 "compact.csv",
                                                 "leaders.csv",
                                                 "power.csv",
                                                 "human_curve.csv",
                                                 "human_curve_by_mesh.csv",
                                                 "human_curve_differences.csv",
                                                 "human_equivalents.csv",
                                                 "human_reliability.csv",
                                                 "smoothing.csv",
                                                 "published.csv"};
  return files;
}

}  // namespace salbench
