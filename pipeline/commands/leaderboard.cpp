// SPDX-License-Identifier: GPL-3.0-or-later
// Every submission is checked against the data and the protocol of this run, and those that pass are scored
// in one graph, as evaluate scores maps: the tables have no score but these.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "io/process.h"
#include "io/scratch_folder.h"
#include "io/values_file.h"
#include "pipeline/commands/conclude.h"
#include "pipeline/commands/package.h"
#include "pipeline/commands/run.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/submission.h"
#include "pipeline/results/record.h"
#include "pipeline/results/table_rows.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::minutes kRendering(10);

struct Entry {
  fs::path file;
  Card card = {};  // as far as it could be read
  std::string program = {}, results = {};
  std::string refused = {};  // why; empty: it is ranked
  std::string remark = {};
  std::string own_scores = {};  // as the run gives them
};

// --- checked ----------------------------------------------------------------------------------------------

std::vector<Entry> archives_in(const fs::path& folder) {
  std::vector<Entry> entries;
  for (const FolderEntry& found : list_folder(folder))
    if (!found.is_folder && lower_case_extension(found.path) == ".zip") entries.push_back({found.path});
  if (entries.empty())
    throw ConfigError(
        fmt::format("{}: has no submission (NAME.zip, as salbench submit writes them)", folder.string()));
  return entries;
}

// Maps in a scratch folder, by number: no name of a submission becomes one of a file.
GivenMaps unpacked(const Submission& submission, const fs::path& archive, const fs::path& folder) {
  make_folder(folder, "");
  std::map<std::string, fs::path> places;
  for (const auto& [item, bytes] : submission.maps) {
    const fs::path place = folder / fmt::format("{}.npy", places.size());
    write_file(place, bytes);
    places[item] = place;
  }
  GivenMaps maps{.source = archive};
  for (const auto& [item, place] : places) maps.items.insert(item);
  maps.read = [places](const std::string& item) -> FileData {
    const std::string bytes = read_file(places.at(item), kMaxItemBytes);
    return {file_digest(bytes), parse_npy(bytes, item)};
  };
  return maps;
}

void require_new_name(const std::vector<Entry>& entries, const Entry& entry, const Config& config) {
  for (const Entry& other : entries)
    if (&other != &entry && other.refused.empty() && other.card.name == entry.card.name)
      throw InputError(
          fmt::format("the name {} is taken by {}", entry.card.name, other.file.filename().string()));
  for (const Model& model : config.models)
    if (!model.given && model.name == entry.card.name)
      throw InputError(fmt::format("the name {} is that of a model of the configuration", entry.card.name));
}

// Adds the models of the submissions that pass.
void check_all(std::vector<Entry>& entries, const Expected& expected, const fs::path& scratch,
               Config& config) {
  for (Entry& entry : entries) entry.refused = "was not checked";
  for (Entry& entry : entries) try {
      const Submission submission = read_submission(entry.file, expected);
      entry.card = submission.card;
      entry.program = submission.manifest.program;
      entry.results = submission.results;
      require_new_name(entries, entry, config);
      config.models.push_back(given_model(
          entry.card.name, unpacked(submission, entry.file, scratch / std::to_string(config.models.size()))));
      entry.refused = "";
    } catch (const FileError& error) {
      entry.refused = error.reason;  // without the folder: the table is the same wherever submissions lie
    } catch (const InputError& error) {
      entry.refused = error.what();
    }
}

// --- scored -----------------------------------------------------------------------------------------------

// A model that failed on any shape is no competitor: all are compared on the same shapes.
void refuse_failed(std::vector<Entry>& entries, const Session& session, std::vector<ResultRow>& rows) {
  const Project& project = session.setup.project;
  std::set<std::string> failed;  // entries that were refused before have no rows; another may have their name
  for (const Failure& failure : session.resolver.failures())
    for (Entry& entry : entries)
      if (entry.refused.empty() && entry.card.name == project.rule(failure.job).subject) {
        entry.refused = fmt::format("{}: {}", project.name(failure.job), failure.cause);
        failed.insert(entry.card.name);
      }
  std::erase_if(rows, [&](const ResultRow& row) { return failed.contains(row.model); });
}

// The scores that came with a submission decide nothing.
void compare_scores(std::vector<Entry>& entries, const std::vector<ResultRow>& rows, const Metrics& metrics) {
  for (Entry& entry : entries) {
    if (!entry.refused.empty()) continue;
    std::vector<ResultRow> own;
    std::ranges::copy_if(rows, std::back_inserter(own),
                         [&](const ResultRow& row) { return row.model == entry.card.name; });
    if (to_csv(results_table(own, metrics)) != entry.results)
      entry.remark = "the scores that it came with are others than those computed here";
  }
}

// --- written ----------------------------------------------------------------------------------------------

Table submissions_table(const std::vector<Entry>& entries) {
  Table table{.columns = {"file", "model", "status", "reason", "remark", "date", "citation", "licence",
                          "training_data", "test_overlap", "url", "program"},
              .rows = {}};
  for (const Entry& entry : entries) {
    const Card& card = entry.card;
    table.rows.push_back({entry.file.filename().string(), card.name,
                          std::string(entry.refused.empty() ? "ranked" : "refused"), entry.refused,
                          entry.remark, card.date, card.citation, card.licence, card.training_data,
                          card.test_overlap, card.url, entry.program});
  }
  return table;
}

Table metrics_table(const Metrics& metrics) {
  Table table{.columns = {"metric", "unit", "better"}, .rows = {}};
  for (const Metric& metric : metrics)
    table.rows.push_back(
        {metric.name, std::string(metric.unit), std::string(metric.higher_is_better ? "higher" : "lower")});
  return table;
}

// By date, then by the name of the file: the mean of each, and whether it was the best until then.
Table history_table(std::vector<Entry> entries, const Table& ranking, const Metrics& metrics) {
  std::erase_if(entries, [](const Entry& entry) { return !entry.refused.empty(); });
  std::ranges::stable_sort(entries, {}, [](const Entry& entry) { return entry.card.date; });
  const std::vector<std::string> named = text_column(ranking, "metric"),
                                 models = text_column(ranking, "model");
  const std::vector<double> means = number_column(ranking, "mean");
  const auto model_at = std::ranges::find(ranking.columns, "metric") - ranking.columns.begin();
  Table table{.columns = {ranking.columns.begin(), ranking.columns.begin() + model_at}, .rows = {}};
  table.columns.insert(table.columns.end(), {"metric", "date", "file", "model", "mean", "best"});
  // Rows of one data set, split and metric stand together.
  for (std::size_t first = 0, end = 0; first < means.size(); first = end) {
    const std::vector<Cell> label(ranking.rows[first].begin(), ranking.rows[first].begin() + model_at);
    const auto same = [&](std::size_t row) {
      return named[row] == named[first] && std::equal(label.begin(), label.end(), ranking.rows[row].begin());
    };
    while (end < means.size() && same(end)) ++end;
    const auto metric = std::ranges::find(metrics, named[first], &Metric::name);
    const bool higher = metric == metrics.end() || metric->higher_is_better;
    double best = higher ? -INFINITY : INFINITY;
    for (const Entry& entry : entries)
      for (std::size_t row = first; row < end; ++row) {
        if (models[row] != entry.card.name || std::isnan(means[row])) continue;
        const bool is_best = higher ? means[row] > best : means[row] < best;
        if (is_best) best = means[row];
        table.rows.push_back(cells(label, named[first], entry.card.date, entry.file.filename().string(),
                                   entry.card.name, means[row], std::string(is_best ? "yes" : "no")));
      }
  }
  return table;
}

void require_own_folder(const fs::path& site) {
  const bool ours = size_of_file(site / "data/submissions.csv").has_value();
  if (is_folder(site) && !ours && !list_folder(site).empty())
    throw ConfigError(
        fmt::format("{}: holds something else than a leaderboard; choose another with --to", site.string()));
}

// False if there are no pages.
bool render(const fs::path& site) try {
  run_command(package_command({"report", "leaderboard", fs::absolute(site).string()}), site, kRendering);
  return size_of_file(site / "index.html").has_value();
} catch (const InputError& error) {
  spdlog::warn("{}: the tables are there, but no pages: {}", site.string(), error.what());
  return false;
}

// --- together ---------------------------------------------------------------------------------------------

// People and chance, beside the models that the command line names.
void keep_references(Config& config, const Arguments& arguments) {
  if (arguments.models.empty())
    std::erase_if(config.models, [](const Model& model) { return !is_reference_model(model.name); });
}

// What there is to say of the data was said by the run over it; failures of maps are reasons in the tables.
class Silence {
 public:
  Silence() { spdlog::set_level(spdlog::level::off); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() { spdlog::set_level(before_); }

 private:
  spdlog::level::level_enum before_ = spdlog::get_level();
};

struct Site {
  std::vector<Entry> entries;
  Concluded concluded;
  bool has_pages = false;
};

void print_site(const Site& site, const Session& session, const Arguments& arguments, ReportFormat format) {
  std::string text = site.concluded.text;
  for (const Entry& entry : site.entries)
    if (!entry.refused.empty())
      text += fmt::format("refused: {}: {}\n", entry.file.filename().string(), entry.refused);
  text += site.has_pages
              ? fmt::format("the leaderboard is {}\n", (fs::path(arguments.to) / "index.html").string())
              : fmt::format("the tables are in {}\n", (fs::path(arguments.to) / "data").string());
  Json document = {{"to", arguments.to},
                   {"submissions", rows_json(submissions_table(site.entries))},
                   {"scores", site.concluded.scores},
                   {"leaders", site.concluded.leaders}};
  document.update(summary_of(session));
  print_report(format, "leaderboard", document, arguments.quiet ? "" : text);
}

Site write_site(Session& session, std::vector<Entry> entries, const fs::path& folder) {
  const Metrics metrics = chosen_metrics(session.setup.config.metrics);
  std::vector<ResultRow> rows = collect_results(session.state());
  refuse_failed(entries, session, rows);
  compare_scores(entries, rows, metrics);
  const Config& config = session.setup.config;
  const fs::path data = folder / "data";
  make_folder(data, "choose another with --to");
  std::vector<std::string> remarks;
  if (config.simulated()) remarks.emplace_back(kSimulatedNote);
  const std::string scores = write_scores(data, session.state(), rows, remarks);
  write_scores_record(data, config, scores);
  write_file(data / "submissions.csv", to_csv(submissions_table(entries)));
  write_file(data / "metrics.csv", to_csv(metrics_table(metrics)));
  write_file(data / "protocol.yaml", protocol_text(config));
  Concluded concluded = conclude_results(data, scores);
  if (concluded)
    write_file(data / "history.csv", to_csv(history_table(entries, read_csv(data / "ranking.csv"), metrics)));
  return {std::move(entries), std::move(concluded)};
}

ExitStatus run_leaderboard(const Arguments& arguments, const std::string& folder, ReportFormat format,
                           const std::atomic<bool>& stop) {
  std::vector<Entry> entries = archives_in(folder);
  require_own_folder(arguments.to);
  Config config = read_configuration(arguments);
  keep_references(config, arguments);
  const ScratchFolder scratch;
  {
    Session session(Setup(config, selection_of(arguments)), progress_of(arguments.quiet), stop);
    session.run(thread_count(arguments), "data");
    if (stop) return interrupted_status(arguments);
    check_all(entries, expected_of(session), scratch.path(), config);
  }
  auto silence = std::make_optional<Silence>();
  Session session(Setup(std::move(config), selection_of(arguments)), progress_of(arguments.quiet), stop);
  session.run(thread_count(arguments));
  silence.reset();
  if (stop) return interrupted_status(arguments);
  Site site = write_site(session, std::move(entries), arguments.to);
  site.has_pages = site.concluded && render(arguments.to);
  print_site(site, session, arguments, format);
  if (report_trouble(site.concluded, fs::path(arguments.to) / "data")) return kDefect;
  const bool any_refused =
      std::ranges::any_of(site.entries, [](const Entry& entry) { return !entry.refused.empty(); });
  const ExitStatus status = finished_status(session);
  return status == kAllDone && any_refused ? kSomeFailed : status;
}

}  // namespace

Subcommand leaderboard_subcommand(Arguments& arguments) {
  const auto folder = std::make_shared<std::string>();
  const FormatWord word = default_format();
  return {"leaderboard", "check and score submissions, and make a site that ranks them",
          leaderboard_parameters(arguments,
                                 {{"FOLDER", folder.get(), "folder of the submissions (NAME.zip)", true},
                                  {"--to", &arguments.to, "folder of the site", true},
                                  {"--models", &arguments.models,
                                   "also these of the configuration (default: people and chance alone)"},
                                  format_parameter(word)}),
          [&arguments, folder, word](const std::atomic<bool>& stop) {
            return run_leaderboard(leaderboard_arguments(arguments), *folder, format_of(word), stop);
          }};
}

}  // namespace salbench
