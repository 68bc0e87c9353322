// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/record.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <sstream>
#include <unordered_set>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "io/file.h"
#include "pipeline/config/section.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/results/libraries.h"
#include "stages/core/errors.h"
#include "stages/core/quantile.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string_view reference_line(const RunState& run) {
  if (reference_is_given(run.project().rules)) return "given by --reference";
  if (run.inputs.shard) return "none, the run was over a share of the items";
  return run.inputs.has_others() ? "mean over all items of the data set or split"
                                 : "mean over the items of the run";
}

// Shapes whose scores are all there, of those that have any to come.
std::pair<std::size_t, std::size_t> finished_shapes(const RunState& run) {
  std::size_t finished = 0, scored = 0;
  for (const Unit unit : run.shapes()) {
    std::size_t jobs = 0, open = 0;
    for (const Job& job : run.project().jobs_of(unit)) {
      if (!has_role(run.project().rule(job), Role::scores)) continue;
      const Decision& decision = run.decision(job);
      jobs += decision.known() || decision.open() ? 1U : 0U;
      open += decision.open() ? 1U : 0U;
    }
    scored += jobs > 0 ? 1U : 0U;
    finished += jobs > 0 && open == 0 ? 1U : 0U;
  }
  return {finished, scored};
}

std::string state_line(const RunRecord& record) {
  if (!record.interrupted) return "finished";
  const auto [finished, scored] = finished_shapes(record.run);
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
                        name_of(metric.matching), metric.weighting == Weighting::area ? "area" : "equal",
                        scores_version({&metric, 1}));
  return yaml;
}

std::string stage_lines(const RunRecord& record) {
  std::string yaml = "stages:  # version, and why this run computed what it did\n";
  for (const StageCount& count :
       count_by_stage(record.run.project(), record.run.resolver.plan(), record.why)) {
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

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

// By stage, in the order of the rules: what the artefacts of this run's jobs occupy. Units may share one.
std::string cache_lines(const RunRecord& record) {
  const RunState& run = record.run;
  std::vector<std::pair<std::string, std::unordered_set<Digest>>> stages;
  for (std::size_t rule = 0; rule < run.project().rules.size(); ++rule) {
    const std::string& stage = run.project().rules[rule].stage;
    auto keys = std::ranges::find(stages, stage, [](const auto& entry) { return entry.first; });
    if (keys == stages.end()) keys = stages.insert(keys, {stage, {}});
    for (const Decision& decision : run.resolver.plan().decisions[rule])
      if (decision.known()) keys->second.insert(decision.key);
  }
  std::string yaml = "cache_bytes:  # of the artefacts of this run, by stage\n";
  for (const auto& [stage, keys] : stages) {
    std::uint64_t bytes = 0;
    for (const Digest& key : keys) bytes += record.store.bytes_of(key).value_or(0);
    yaml += fmt::format("  {}: {}\n", stage, bytes);
  }
  return yaml;
}

std::string remark_lines(const RunRecord& record) {
  const RunState& run = record.run;
  std::string yaml;
  for (const Job& job : run.project().jobs()) {
    if (!run.project().rule(job).remarks || !run.decision(job).known() || !run.units().is_chosen(job.unit))
      continue;
    if (const std::string remark =
            run.resolver.store().remark(run.project().rule(job).stage, run.decision(job).key);
        !remark.empty())
      yaml += fmt::format("  - {{item: {}, remark: {}}}\n", yaml_quoted(run.project().name(job)),
                          yaml_quoted(remark));
  }
  return yaml.empty() ? "remarks: []\n" : "remarks:  # on odd shapes\n" + yaml;
}

// The fewest and the most people that files tell apart, over the shapes of the run with ground truth; [0, 0]:
// all of them are pooled.
std::string participants_text(const Inputs& inputs) {
  std::optional<std::size_t> fewest;
  std::size_t most = 0;
  for (const Family& family : inputs.units.families()) {
    const DatasetItem& item = item_of(family.source);
    if (!family.chosen || truth_files_of(item).empty()) continue;
    const std::size_t told_apart = has_participants(item) ? participants_of(item) : 0;
    fewest = std::min(fewest.value_or(told_apart), told_apart);
    most = std::max(most, told_apart);
  }
  return fmt::format("[{}, {}]", fewest.value_or(0), most);
}

std::string configuration_lines(const Config& config) {
  std::string yaml = "configuration:\n";
  std::istringstream lines(config_yaml(config));
  for (std::string line; std::getline(lines, line);) yaml += "  " + line + "\n";
  return yaml;
}

std::string run_yaml(const RunRecord& record) {
  const auto& [config, inputs, resolver] = record.run;
  std::string yaml;
  if (config.simulated()) yaml += fmt::format("# {}\n", kSimulatedNote);
  if (!inputs.remark.empty()) yaml += fmt::format("# {}\n", inputs.remark);
  yaml += fmt::format("program: salbench {}\nresults: {}\nhost: {}\n", SALBENCH_VERSION, state_line(record),
                      yaml_quoted(host_name()));
  yaml += fmt::format("libraries: {}\n", yaml_quoted(fmt::format("{}", fmt::join(libraries(), ", "))));
  yaml += fmt::format("threads: {}\nseconds: {:.3f}\npeak_memory_mb: {:.1f}\nartefacts_computed: {}\n",
                      record.threads, record.seconds, peak_memory_mb(), resolver.computed());
  if (inputs.shard) yaml += fmt::format("shard: {}\n", inputs.shard->text());
  if (!record.scores.empty()) yaml += fmt::format("scores_digest: {}\n", record.scores);
  yaml += fmt::format("reference: {}\n", reference_line(record.run));
  for (const Model& model : config.models)
    if (model.given)
      yaml += fmt::format("evaluated: {{model: {}, maps: {}, matched: {}}}\n", model.name,
                          yaml_quoted(model.given->source.string()), model.given->matched);
  const DataIdentity data = identity_of(inputs);
  const std::size_t clouds = inputs.count(kClouds);
  yaml += fmt::format(
      "data_set: {{folder: {}, layout: {}, meshes: {}, {}files: {}, digest: {}, {}participants: {}}}\n",
      yaml_quoted(config.data), yaml_scalar(inputs.layout), inputs.count(kMeshes),
      clouds > 0 ? fmt::format("clouds: {}, ", clouds) : "", data.files, data.digest.hex(),
      inputs.splits.empty() ? "" : fmt::format("splits: {}, ", inputs.splits), participants_text(inputs));
  yaml += metric_lines(chosen_metrics(config.metrics));
  yaml += stage_lines(record);
  yaml += cache_lines(record);
  yaml += remark_lines(record);
  const std::vector<Failure> failures = resolver.failures();
  yaml += failures.empty() && inputs.errors.empty() ? "failed: []\n" : "failed:\n";
  for (const std::string& error : inputs.errors)
    yaml += fmt::format("  - {{item: \"\", stage: data set, cause: {}}}\n", yaml_quoted(error));
  for (const Failure& failure : failures)
    yaml += fmt::format("  - {{item: {}, stage: {}, cause: {}}}\n",
                        yaml_quoted(resolver.project().name(failure.job)),
                        resolver.project().rule(failure.job).stage, yaml_quoted(failure.cause));
  return yaml + configuration_lines(config);
}

}  // namespace

void write_record(const fs::path& folder, const RunRecord& record) {
  write_file(folder / "timeline.csv",
             to_csv(timeline_table(record.run.project().rules, record.run.resolver.records(), record.started,
                                   record.seconds)));
  write_file(folder / "run.yaml", run_yaml(record));
}

void write_shard_record(const fs::path& folder, const RunRecord& record) {
  const Shard& shard = *record.run.inputs.shard;
  write_file(folder / fmt::format("shard_{}_of_{}.yaml", shard.index, shard.count), run_yaml(record));
}

std::string state_of_results(const fs::path& folder) try {
  return Section::from_file((folder / "run.yaml").string()).text("results").value_or("");
} catch (const ConfigError&) {
  return {};
}

}  // namespace salbench
