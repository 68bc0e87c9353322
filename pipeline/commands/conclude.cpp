// SPDX-License-Identifier: GPL-3.0-or-later
// conclusions.json is written last and removed first: where it is, all tables of conclusions are, and are of
// the scores that it names.
#include "pipeline/commands/conclude.h"

#include <chrono>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/commands/process.h"
#include "io/digest.h"
#include "io/file.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/package/package.h"
#include "pipeline/results/tables.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConclusions = "conclusions.json";
constexpr int kFormat = 1;              // of this file
const std::string kDigest = "xxh128:";  // how it has those of tables
constexpr std::chrono::hours kLongest(2);

std::string digest_of(const RunState& run, const std::vector<TableFile>& files) {
  Hasher hasher;
  hasher.add(SALBENCH_VERSION);
  hasher.add(name_of(run.config.statistics.unit));
  hasher.add(run.config.seed);
  for (const TableFile& file : files)
    if (file.is_of_scores && file.text) {
      hasher.add(file.name);
      hasher.add(*file.text);
    }
  return hasher.digest().hex();
}

// The document in the folder; null unless it is of this digest, and all its tables are there and as they were
// when it was written.
Json conclusions_in(const fs::path& folder, const std::string& digest) try {
  if (!size_of_file(folder / kConclusions)) return {};
  Json document = Json::parse(read_file(folder / kConclusions));
  if (document.at("format") != kFormat || document.at("of") != digest) return {};
  for (const Json& table : document.value("tables", Json::array())) {
    const auto name = table.get<std::string>();
    if (document.at("files").at(name) != kDigest + xxh128(read_file(folder / name, kMaxItemBytes)).hex())
      return {};
  }
  return document;
} catch (const Json::exception&) {  // edited, or another's
  return {};
} catch (const InputError&) {  // a table that is gone, or no file
  return {};
}

Concluded concluded_by(const Json& document) {
  return {.text = document.at("text").get<std::string>(),
          .scores = document.at("scores"),
          .leaders = document.at("leaders")};
}

}  // namespace

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

std::string write_scores(const fs::path& folder, const RunState& run, const std::vector<ResultRow>& rows,
                         const std::vector<std::string>& remarks) {
  const std::vector<TableFile> files = table_files(run, rows, remarks);
  const std::string digest = digest_of(run, files);
  if (conclusions_in(folder, digest).is_null())
    for (const std::string& name : files_of_conclusions()) remove_file(folder / name);
  for (const auto& [name, text, is_of_scores] : files)
    text ? write_file(folder / name, *text) : remove_file(folder / name);
  remove_file(folder / kFoldsTable);
  return digest;
}

std::vector<std::string> files_of_scores() {
  std::vector<std::string> files = names_of_tables();
  files.insert(files.end(), files_of_conclusions().begin(), files_of_conclusions().end());
  return files;
}

void remove_scores(const fs::path& folder) {
  for (const std::string& name : files_of_scores()) remove_file(folder / name);
}

Concluded conclude_results(const fs::path& folder, const std::string& digest) try {
  if (const Json document = conclusions_in(folder, digest); !document.is_null())
    return concluded_by(document);
  if (const std::string wrong = wrong_with_interpreter(); !wrong.empty()) return {.missing = wrong};
  const CommandEnd end =
      try_command(package_command({"conclude", fs::absolute(folder).string(), "--of", digest, "--quiet"}),
                  fs::current_path(), kLongest);
  if (end.status == kNoPackage) return {.missing = end.printed};
  if (const std::string none = no_interpreter(end.status); !none.empty()) return {.missing = none};
  if (end.status != 0) return {.failure = fmt::format("{}; {}", end.reason, said_of(end.printed))};
  const Json document = conclusions_in(folder, digest);
  if (document.is_null())
    return {.failure = fmt::format("{} is not as this version writes it", kConclusions)};
  return concluded_by(document);
} catch (const Json::exception& error) {
  return {.failure = fmt::format("{}: {}", kConclusions, error.what())};
} catch (const InputError& error) {
  return {.failure = error.what()};
}

bool report_trouble(const Concluded& concluded, const fs::path& folder) {
  if (!concluded.missing.empty()) spdlog::warn("no conclusions: {}", concluded.missing);
  if (concluded.failure.empty()) return false;
  spdlog::error(
      "{}: the scores are there, but no conclusions from them: {}; salbench conclude {} tries again",
      folder.string(), concluded.failure, shell_quoted(folder.string()));
  return true;
}

}  // namespace salbench
