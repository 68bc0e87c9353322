// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>
#include <tbb/version.h>
#include <unistd.h>

#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "pipeline/config/section.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/results/costs.h"
#include "pipeline/rules/command_model.h"
#include "pipeline/rules/gaze.h"
#include "stages/core/errors.h"
#include "stages/geometry/embree.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// --- format -----------------------------------------------------------------------------------------------

// Key of the record: a YAML value on its line, or indented lines below a note. Left out if both are empty.
struct Entry {
  std::string_view key;
  std::string value = {};
  std::string lines = {};
  std::string_view note = {};
};

std::string text_of(const std::vector<Entry>& entries) {
  std::string yaml;
  for (const auto& [key, value, lines, note] : entries) {
    if (!value.empty()) yaml += fmt::format("{}: {}\n", key, value);
    if (!lines.empty()) yaml += fmt::format("{}:{}{}\n", key, note.empty() ? "" : "  # ", note);
    yaml += indented(lines, "  ");
  }
  return yaml;
}

// One row per element; an empty list is written as [].
Entry list_entry(std::string_view key, const std::vector<YamlFields>& rows, std::string_view note = {}) {
  Entry entry{.key = key, .value = rows.empty() ? "[]" : "", .note = note};
  for (const YamlFields& row : rows) entry.lines += fmt::format("- {}\n", yaml_mapping(row));
  return entry;
}

std::string decimal(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

// --- the program and the machine --------------------------------------------------------------------------

// A loaded version matches the headers' if it begins with it: "2021.8.0" and "2021.8".
std::string library_text(const char* name, const LibraryVersion& version) {
  const bool other = !version.loaded.starts_with(version.built);
  return fmt::format("{} {}{}", name, version.loaded,
                     other ? fmt::format(" (built with {})", version.built) : "");
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return name;
}

// In 10^6 bytes; empty without /proc. getrusage would report at least the peak of the parent process, such as
// a notebook.
std::string peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string name; status >> name; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n'))
    if (double kib = 0; name == "VmHWM:" && status >> kib) return decimal(kib * 1024 / 1e6, 1);
  return "";
}

// --- the data ---------------------------------------------------------------------------------------------

// Fewest and most participants told apart, over the run's shapes with ground truth; [0, 0] if all are pooled.
std::string participants_text(const Inputs& inputs, bool from_gaze) {
  std::optional<std::size_t> fewest;
  std::size_t most = 0;
  for (const Family& family : inputs.units.families()) {
    const Item& item = item_of(family.source);
    if (!family.chosen || (from_gaze ? !item.is_recorded() : truth_files_of(item).empty())) continue;
    const std::size_t people = from_gaze ? item.recorded : participants_of(item);
    const std::size_t told_apart = people >= kMinParticipants ? people : 0;
    fewest = std::min(fewest.value_or(told_apart), told_apart);
    most = std::max(most, told_apart);
  }
  return fmt::format("[{}, {}]", fewest.value_or(0), most);
}

// Items that repeat another item's shape and ground truth, after the first such item: one observation.
std::string copies_text(const RunState& run) {
  std::map<Unit, Digest> shapes;
  for (const Job& job : run.known(Role::shape)) shapes[job.unit] = run.decision(job).content;
  std::map<std::pair<Digest, Digest>, std::vector<std::string>> items;
  for (const Job& job : run.known(Role::ground_truth)) {
    const auto shape = shapes.find(job.unit);
    if (shape == shapes.end() || job.unit.level == kScans || !run.units().is_chosen(job.unit)) continue;
    std::vector<std::string>& names = items[{shape->second, run.decision(job).content}];
    const std::string name = yaml_quoted(item_of(run.units(), job.unit).shape_name());
    if (names.empty() || names.back() != name) names.push_back(name);  // views of an item are not copies
  }
  std::vector<std::string> copies;
  for (const auto& [contents, names] : items)
    if (names.size() > 1) copies.push_back(fmt::format("[{}]", fmt::join(names, ", ")));
  std::ranges::sort(copies);
  return copies.empty() ? "" : fmt::format("[{}]", fmt::join(copies, ", "));
}

std::string data_set_text(const RunState& run, bool from_gaze) {
  const DataIdentity data = identity_of(run.inputs);
  const std::size_t clouds = run.inputs.count(kClouds);
  return yaml_mapping({{"folder", yaml_quoted(run.config.data)},
                       {"layout", yaml_scalar(run.inputs.layout)},
                       {"meshes", run.inputs.count(kMeshes)},
                       {"clouds", clouds > 0 ? std::to_string(clouds) : ""},
                       {"files", data.files},
                       {"digest", data.digest.hex()},
                       {"splits", run.inputs.splits},
                       {"participants", participants_text(run.inputs, from_gaze)}});
}

// Models whose maps another program computed, with the source of the maps. A mapping for one, a list for
// several.
std::string evaluated_text(const std::vector<Model>& models) {
  std::vector<std::string> given;
  for (const Model& model : models)
    if (model.given)
      given.push_back(yaml_mapping({{"model", model.name},
                                    {"maps", yaml_quoted(fs::absolute(model.given->source).string())},
                                    {"matched", option_text(model.given->matched)}}));
  const std::string text = fmt::format("{}", fmt::join(given, ", "));
  return given.size() > 1 ? "[" + text + "]" : text;
}

// Files (code, weights) that each model's command depends on, with digests, which the keys of its maps
// contain.
std::string command_file_lines(const Rules& rules) {
  std::map<std::string_view, YamlFields> by_model;
  for (const Rule& rule : rules) {
    if (!has_role(rule, Role::map)) continue;
    YamlFields files;
    for (const OptionLines& options : rule.options)
      for (const std::string& line : lines_in(options.in_key))
        if (line.starts_with(kDependsOption)) {
          const std::size_t colon = line.rfind(": ");  // the last colon: names may contain others
          const std::string name = line.substr(kDependsOption.size(), colon - kDependsOption.size());
          files.emplace_back(yaml_quoted(name), yaml_quoted(line.substr(colon + 2)));
        }
    if (!files.empty()) by_model[rule.subject] = files;  // equal for meshes and scans
  }
  std::string lines;
  for (const auto& [model, files] : by_model) lines += fmt::format("{}: {}\n", model, yaml_mapping(files));
  return lines;
}

// --- the work ---------------------------------------------------------------------------------------------

// Interrupted run: number of shapes with complete scores, out of the shapes that are scored.
std::string state_text(const RunRecord& record) {
  if (!record.interrupted) return "finished";
  std::size_t finished = 0, scored = 0;
  for (const Unit unit : record.run.shapes()) {
    bool any_known = false, any_open = false;
    for (const Job& job : record.run.project().jobs_of(unit)) {
      if (!has_role(record.run.project().rule(job), Role::scores)) continue;
      any_known |= record.run.decision(job).known();
      any_open |= record.run.decision(job).open();
    }
    scored += any_known || any_open ? 1U : 0U;
    finished += any_known && !any_open ? 1U : 0U;
  }
  return fmt::format("partial, {} of {} shapes have all scores", finished, scored);
}

std::string metric_lines(const Metrics& metrics) {
  std::string lines;
  for (const Metric& metric : metrics)
    lines += fmt::format("{}: {}\n", metric.name,
                         yaml_mapping({{"unit", yaml_quoted(metric.unit)},
                                       {"better", metric.higher_is_better ? "higher" : "lower"},
                                       {"matching", option_text(metric.matching)},
                                       {"weighting", metric.reads == Reads::areas ? "area" : "equal"},
                                       {"version", scores_version({&metric, 1})}}));
  return lines;
}

std::string stage_lines(const RunState& run) {
  std::string lines;
  for (const StageCount& count : count_by_stage(run.project(), run.resolver.plan(), Counted::computed)) {
    YamlFields why;
    // After a question mark, a YAML key may exceed the usual limit of 1024 characters.
    for (const auto& [reason, n] : count.reasons)
      why.emplace_back((reason.size() > 500 ? "? " : "") + yaml_quoted(reason), n);
    lines += fmt::format("{}: {}\n", count.stage,
                         yaml_mapping({{"version", count.version}, {"why", yaml_mapping(why)}}));
  }
  return lines;
}

// Linear interpolation at q (n - 1). [hyndman1996, definition 7]
double quantile(const std::vector<float>& ascending, double q) {
  const double position = q * static_cast<double>(ascending.size() - 1);
  const auto before = static_cast<std::size_t>(position);
  const std::size_t after = std::min(before + 1, ascending.size() - 1);
  return std::lerp(double{ascending[before]}, double{ascending[after]}, position - std::floor(position));
}

YamlFields node_fields(const Rule& rule, const RuleRecord& node, std::size_t units, double core_seconds) {
  std::vector<float> seconds = node.seconds;
  const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  if (seconds.empty()) seconds = {0};
  std::ranges::sort(seconds);
  return {{"stage", rule.stage},
          {"of", shapes_name(rule.over)},
          {"scope", levels()[rule.level()].unit},
          {"items", units},
          {"settled", node.settled},
          {"computed", node.seconds.size()},
          {"seconds", decimal(sum, 3)},
          {"median", decimal(quantile(seconds, 0.5), 4)},
          {"p95", decimal(quantile(seconds, 0.95), 4)},
          {"busy", decimal(core_seconds > 0 ? sum / core_seconds : 0, 4)},
          {"processor", decimal(node.processor_seconds, 3)}};
}

std::vector<YamlFields> nodes(const RunRecord& record) {
  const Project& project = record.run.project();
  const std::vector<RuleRecord>& of_rules = record.run.resolver.records();
  std::vector<YamlFields> rows;
  for (std::size_t rule = 0; rule < of_rules.size(); ++rule)
    rows.push_back(node_fields(project.rules[rule], of_rules[rule], project.units_of(rule).size(),
                               record.seconds * record.threads));
  return rows;
}

// Disk space of this run's artefacts. Units may share one.
std::string cache_lines(const RunRecord& record) {
  const Rules& all = record.run.project().rules;
  std::string lines;
  for (const std::vector<std::size_t>& rules : rules_by_stage(all)) {
    std::unordered_set<Digest> keys;
    for (const std::size_t rule : rules)
      for (const Decision& decision : record.run.resolver.plan().decisions[rule])
        if (decision.known()) keys.insert(decision.key);
    std::uint64_t bytes = 0;
    for (const Digest& key : keys) bytes += record.store.bytes_of(key).value_or(0);
    lines += fmt::format("{}: {}\n", all[rules[0]].stage, bytes);
  }
  return lines;
}

std::vector<YamlFields> remarks(const RunState& run) {
  std::vector<YamlFields> rows;
  for (const Job& job : run.project().jobs()) {
    if (!run.project().rule(job).remarks || !run.decision(job).known() || !run.units().is_chosen(job.unit))
      continue;
    if (const std::string remark = run.resolver.store().remark(run.decision(job).key); !remark.empty())
      rows.push_back({{"item", yaml_quoted(run.project().name(job))}, {"remark", yaml_quoted(remark)}});
  }
  return rows;
}

std::vector<YamlFields> failed(const RunState& run) {
  std::vector<YamlFields> rows;
  const auto add = [&](std::string_view item, std::string_view stage, std::string_view cause) {
    rows.push_back({{"item", yaml_quoted(item)}, {"stage", stage}, {"cause", yaml_quoted(cause)}});
  };
  for (const std::string& error : run.inputs.errors) add("", "data set", error);
  for (const auto& [job, cause, defect] : run.resolver.failures())
    add(run.project().name(job), run.project().rule(job).stage, cause);
  return rows;
}

// --- record -----------------------------------------------------------------------------------------------

const Entry kProgram = {"program", "salbench " SALBENCH_VERSION};

Entry selection_entry(const std::string& lines) {
  return {.key = "selection", .lines = lines, .note = "of the items, and what maps are matched to"};
}

std::string configuration_text(const Config& config) {
  return text_of(
      {{.key = "configuration_folder", .value = config.folder.empty() ? "" : yaml_quoted(config.folder)},
       {.key = "configuration", .lines = config_yaml(config)}});
}

std::string run_yaml(const RunRecord& record) {
  const auto& [config, inputs, resolver] = record.run;
  const bool from_gaze = is_from_gaze(config, inputs);
  const LibraryTime hdf5 = hdf5_time();
  std::string yaml;
  if (config.simulated()) yaml += fmt::format("# {}\n", kSimulatedNote);
  if (!inputs.remark.empty()) yaml += fmt::format("# {}\n", inputs.remark);
  yaml += text_of(
      {kProgram,
       {"results", state_text(record)},
       {"host", yaml_quoted(host_name())},
       {"libraries", yaml_quoted(fmt::format("{}", fmt::join(libraries(), ", ")))},
       {"threads", std::to_string(record.threads)},
       {"seconds", decimal(record.seconds, 3)},
       {"peak_memory_mb", peak_memory_mb()},
       {"artefacts_computed", std::to_string(resolver.computed())},
       {"hdf5_seconds", yaml_mapping({{"held", decimal(hdf5.held, 3)}, {"waited", decimal(hdf5.waited, 3)}})},
       {"shard", inputs.shard ? inputs.shard->text() : ""},
       {"scores_digest", record.scores},
       {"reference", reference_text(record.run, "run")},
       selection_entry(record.selection),
       {"evaluated", evaluated_text(config.models)},
       {"ground_truth", from_gaze ? gaze_recipe(config.gaze) : ""},
       {"data_set", data_set_text(record.run, from_gaze)},
       {"copies", copies_text(record.run)},
       {"notes", inputs.notes.empty() ? "" : option_text(inputs.notes, true)},
       {.key = "metrics",
        .lines = metric_lines(chosen_metrics(config.metrics)),
        .note = "columns of the tables"},
       {.key = "stages",
        .lines = stage_lines(record.run),
        .note = "version, and why this run computed what it did"},
       list_entry("nodes", nodes(record),
                  "jobs done and computed; seconds: sum, median, 95th percentile; share of the cores' "
                  "time; processor time, s"),
       {.key = "cache_bytes", .lines = cache_lines(record), .note = "of the artefacts of this run, by stage"},
       list_entry("remarks", remarks(record.run), "on odd shapes"),
       list_entry("failed", failed(record.run)),
       {.key = "command_files",
        .lines = command_file_lines(record.run.project().rules),
        .note = "with their digests"}});
  return yaml + configuration_text(config);
}

}  // namespace

void write_record(const fs::path& folder, const RunRecord& record) {
  const auto& [config, inputs, resolver] = record.run;
  if (inputs.shard)
    return write_file(folder / fmt::format("shard_{}_of_{}.yaml", inputs.shard->index, inputs.shard->count),
                      run_yaml(record));
  write_file(folder / "costs.csv", to_csv(costs_table(record.run, record.store)));
  write_file(folder / kRecord, run_yaml(record));
}

std::string unfinished_record(const Config& config, const std::string& selection) {
  return std::string(kUnderWay) +
         text_of({kProgram, selection_entry(selection), {"evaluated", evaluated_text(config.models)}}) +
         configuration_text(config);
}

std::string state_of_results(const fs::path& folder) try {
  return Section::from_file((folder / kRecord).string()).text("results").value_or("");
} catch (const ConfigError&) {
  return {};
}

std::vector<std::string> libraries() {
  return {library_text("oneTBB", {TBB_VERSION_STRING, TBB_runtime_version()}),
          library_text("HDF5", hdf5_version()),
          fmt::format("Embree {}", embree::version()),
          "Eigen " SALBENCH_EIGEN,
          "PCL " SALBENCH_PCL,
          "CGAL " SALBENCH_CGAL};
}

}  // namespace salbench
