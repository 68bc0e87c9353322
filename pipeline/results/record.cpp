// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/record.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <unordered_set>

#include <fmt/format.h>
#include <tbb/version.h>
#include <unistd.h>

#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "pipeline/config/section.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/results/costs.h"
#include "pipeline/results/quantile.h"
#include "pipeline/rules/command_model.h"
#include "pipeline/rules/gaze.h"
#include "stages/core/errors.h"
#include "stages/geometry/embree.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// "2021.8.0" begins with the "2021.8" of the headers.
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

// Of an interrupted run: the shapes whose scores are all there, of those that have any to come.
std::string state_line(const RunRecord& record) {
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

std::string node_line(const Rule& rule, const RuleRecord& node, std::size_t units, double core_seconds) {
  std::vector<double> seconds(node.seconds.begin(), node.seconds.end());
  const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  if (seconds.empty()) seconds = {0};
  return fmt::format(
      "  - {{stage: {}, of: {}, scope: {}, items: {}, settled: {}, computed: {}, seconds: {:.3f}, "
      "median: {:.4f}, p95: {:.4f}, busy: {:.4f}, processor: {:.3f}}}\n",
      rule.stage, shapes_name(rule.over), levels()[rule.level()].unit, units, node.settled,
      node.seconds.size(), sum, median(seconds), quantile(seconds, 0.95),
      core_seconds > 0 ? sum / core_seconds : 0, node.processor_seconds);
}

std::string metric_lines(const Metrics& metrics) {
  std::string yaml = "metrics:  # columns of the tables\n";
  for (const Metric& metric : metrics)
    yaml += fmt::format("  {}: {{unit: {}, better: {}, matching: {}, weighting: {}, version: {}}}\n",
                        metric.name, yaml_quoted(metric.unit), metric.higher_is_better ? "higher" : "lower",
                        name_of(metric.matching), metric.reads == Reads::areas ? "area" : "equal",
                        scores_version({&metric, 1}));
  return yaml;
}

std::string stage_lines(const RunRecord& record) {
  std::string yaml = "stages:  # version, and why this run computed what it did\n";
  for (const StageCount& count :
       count_by_stage(record.run.project(), record.run.resolver.plan(), Counted::computed)) {
    std::string why;
    // Behind a question mark a key may be longer than the 1024 characters that YAML allows it elsewhere.
    for (const auto& [reason, n] : count.reasons)
      why += fmt::format("{}{}{}: {}", why.empty() ? "" : ", ", reason.size() > 500 ? "? " : "",
                         yaml_quoted(reason), n);
    yaml += fmt::format("  {}: {{version: {}, why: {{{}}}}}\n", count.stage, count.version, why);
  }
  yaml +=
      "nodes:  # jobs settled and computed; seconds: sum, median, 95th percentile; share of the cores' time; "
      "processor time, s\n";
  const Project& project = record.run.project();
  const std::vector<RuleRecord>& nodes = record.run.resolver.records();
  for (std::size_t rule = 0; rule < nodes.size(); ++rule)
    yaml += node_line(project.rules[rule], nodes[rule], project.units_of(rule).size(),
                      record.seconds * record.threads);
  return yaml;
}

// In 10^6 bytes; empty where there is no /proc. That of getrusage would be at least what the process that
// started this one has held, such as a notebook.
std::string peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string name; status >> name; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n'))
    if (double kib = 0; name == "VmHWM:" && status >> kib) return fmt::format("{:.1f}", kib * 1024 / 1e6);
  return "";
}

// What the artefacts of this run's jobs occupy. Units may share one.
std::string cache_lines(const RunRecord& record) {
  const RunState& run = record.run;
  std::string yaml = "cache_bytes:  # of the artefacts of this run, by stage\n";
  for (const std::vector<std::size_t>& rules : rules_by_stage(run.project().rules)) {
    std::unordered_set<Digest> keys;
    for (const std::size_t rule : rules)
      for (const Decision& decision : run.resolver.plan().decisions[rule])
        if (decision.known()) keys.insert(decision.key);
    std::uint64_t bytes = 0;
    for (const Digest& key : keys) bytes += record.store.bytes_of(key).value_or(0);
    yaml += fmt::format("  {}: {}\n", run.project().rules[rules[0]].stage, bytes);
  }
  return yaml;
}

std::string remark_lines(const RunRecord& record) {
  const RunState& run = record.run;
  std::string yaml;
  for (const Job& job : run.project().jobs()) {
    if (!run.project().rule(job).remarks || !run.decision(job).known() || !run.units().is_chosen(job.unit))
      continue;
    if (const std::string remark = run.resolver.store().remark(run.decision(job).key); !remark.empty())
      yaml += fmt::format("  - {{item: {}, remark: {}}}\n", yaml_quoted(run.project().name(job)),
                          yaml_quoted(remark));
  }
  return yaml.empty() ? "remarks: []\n" : "remarks:  # on odd shapes\n" + yaml;
}

// The fewest and the most people that files tell apart, over the shapes of the run with ground truth; [0, 0]:
// all of them are pooled.
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

// The files that the command of each model depends on (code, weights), with their digests: the keys of its
// maps contain both.
std::string command_file_lines(const Rules& rules) {
  std::map<std::string, std::string> by_model;  // rules of meshes and of scans have the same
  for (const Rule& rule : rules) {
    if (!has_role(rule, Role::map)) continue;
    std::string files;
    for (const OptionLines& options : rule.options) {
      std::istringstream lines(options.in_key);
      for (std::string line; std::getline(lines, line);)
        if (line.starts_with(kDependsOption)) {
          const std::size_t colon = line.rfind(": ");  // a name may have others
          files += fmt::format("{}{}: {}", files.empty() ? "" : ", ",
                               yaml_quoted(line.substr(kDependsOption.size(), colon - kDependsOption.size())),
                               yaml_quoted(line.substr(colon + 2)));
        }
    }
    if (!files.empty()) by_model[rule.subject] = files;
  }
  std::string yaml;
  for (const auto& [model, files] : by_model) yaml += fmt::format("  {}: {{{}}}\n", model, files);
  return yaml.empty() ? "" : "command_files:  # with their digests\n" + yaml;
}

std::string failed_lines(const RunState& run) {
  std::string yaml;
  const auto add = [&](std::string_view item, std::string_view stage, std::string_view cause) {
    yaml +=
        fmt::format("  - {{item: {}, stage: {}, cause: {}}}\n", yaml_quoted(item), stage, yaml_quoted(cause));
  };
  for (const std::string& error : run.inputs.errors) add("", "data set", error);
  for (const auto& [job, cause, defect] : run.resolver.failures())
    add(run.project().name(job), run.project().rule(job).stage, cause);
  return yaml.empty() ? "failed: []\n" : "failed:\n" + yaml;
}

// Models whose maps another program made, and from where the run read these. One is a mapping, several are a
// list of mappings.
std::string evaluated_line(const std::vector<Model>& models) {
  std::vector<std::string> given;
  for (const Model& model : models)
    if (model.given)
      given.push_back(fmt::format("{{model: {}, maps: {}, matched: {}}}", model.name,
                                  yaml_quoted(std::filesystem::absolute(model.given->source).string()),
                                  model.given->matched));
  if (given.empty()) return "";
  const bool several = given.size() > 1;
  return fmt::format("evaluated: {}{}{}\n", several ? "[" : "", fmt::join(given, ", "), several ? "]" : "");
}

std::string program_line() { return "program: salbench " SALBENCH_VERSION "\n"; }

std::string configuration_lines(const Config& config) {
  return (config.folder.empty() ? ""
                                : fmt::format("configuration_folder: {}\n", yaml_quoted(config.folder))) +
         "configuration:\n" + indented(config_yaml(config), "  ");
}

std::string run_yaml(const RunRecord& record) {
  const auto& [config, inputs, resolver] = record.run;
  std::string yaml;
  if (config.simulated()) yaml += fmt::format("# {}\n", kSimulatedNote);
  if (!inputs.remark.empty()) yaml += fmt::format("# {}\n", inputs.remark);
  yaml +=
      program_line() + fmt::format("results: {}\nhost: {}\n", state_line(record), yaml_quoted(host_name()));
  yaml += fmt::format("libraries: {}\n", yaml_quoted(fmt::format("{}", fmt::join(libraries(), ", "))));
  yaml += fmt::format("threads: {}\nseconds: {:.3f}\npeak_memory_mb: {}\nartefacts_computed: {}\n",
                      record.threads, record.seconds, peak_memory_mb(), resolver.computed());
  const LibraryTime hdf5 = hdf5_time();
  yaml += fmt::format("hdf5_seconds: {{held: {:.3f}, waited: {:.3f}}}\n", hdf5.held, hdf5.waited);
  if (inputs.shard) yaml += fmt::format("shard: {}\n", inputs.shard->text());
  if (!record.scores.empty()) yaml += fmt::format("scores_digest: {}\n", record.scores);
  yaml += fmt::format("reference: {}\n", reference_text(record.run, "run"));
  yaml += record.selection;
  yaml += evaluated_line(config.models);
  const bool from_gaze = is_from_gaze(config, inputs);
  if (from_gaze) yaml += fmt::format("ground_truth: {}\n", gaze_recipe(config.gaze));
  const DataIdentity data = identity_of(inputs);
  const std::size_t clouds = inputs.count(kClouds);
  yaml += fmt::format(
      "data_set: {{folder: {}, layout: {}, meshes: {}, {}files: {}, digest: {}, {}participants: {}}}\n",
      yaml_quoted(config.data), yaml_scalar(inputs.layout), inputs.count(kMeshes),
      clouds > 0 ? fmt::format("clouds: {}, ", clouds) : "", data.files, data.digest.hex(),
      inputs.splits.empty() ? "" : fmt::format("splits: {}, ", inputs.splits),
      participants_text(inputs, from_gaze));
  if (!inputs.notes.empty()) yaml += fmt::format("notes: {}\n", option_text(inputs.notes, true));
  yaml += metric_lines(chosen_metrics(config.metrics));
  yaml += stage_lines(record);
  yaml += cache_lines(record);
  yaml += remark_lines(record);
  yaml += failed_lines(record.run);
  yaml += command_file_lines(record.run.project().rules);
  return yaml + configuration_lines(config);
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
  return std::string(kUnderWay) + program_line() + selection + evaluated_line(config.models) +
         configuration_lines(config);
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
