// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/explain.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/cli.h"
#include "pipeline/commands/report.h"
#include "pipeline/rules/depended_files.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using Part = RecipeDifference::Part;

constexpr std::size_t kMaxNamed = 4;  // differences in one line; the others are counted

std::string joined(const std::vector<std::string>& parts) {
  const std::size_t named = std::min(parts.size(), kMaxNamed);
  std::string text =
      fmt::format("{}", fmt::join(parts.begin(), parts.begin() + static_cast<long>(named), ", "));
  return named == parts.size() ? text : fmt::format("{} and {} more", text, parts.size() - named);
}

std::string or_none(const std::string& value) { return value.empty() ? "none" : value; }

// Fate of an input that a key names.
std::string fate(const RecipeDifference& difference) {
  if (difference.before.empty()) return "added";
  return difference.after.empty() ? "removed" : "changed";
}

// The same of a file. The cache knows its contents and not its folder, so that two data sets may have one of
// this name: nothing says that it changed.
std::string file_text(const std::string& title, const RecipeDifference& difference) {
  const std::string what = fate(difference);
  return what == "changed" ? title + ": other contents" : fmt::format("{} {}", title, what);
}

// The job that a key calls by this name among the inputs of another; nothing for a file.
std::optional<Job> input_named(const Project& project, const Job& job, const std::string& name) {
  for (std::size_t i = 0; i < project.rule(job).inputs.size(); ++i)
    if (const Job input = project.input_job(job, i); project.rule(input).stage == name) return input;
  return {};
}

// "mesh file .off" -> "mesh file 52.off": keys hold no names of files. One that is read no more keeps its
// name.
std::string source_text(std::span<const File> files, const std::string& name) {
  const auto file = std::ranges::find(files, name, &File::name);
  return file == files.end() || file->title.empty() ? name : file->title;
}

// Words for a difference that are the same for every unit.
std::string group_text(const Project& project, const Job& job, const RecipeDifference& difference) {
  const auto without_unit = [&](const std::string& seed) {
    return or_none(seed.substr(0, std::min(seed.size(), seed.find('/'))));
  };
  switch (difference.part) {
    case Part::version:
      return fmt::format("stage version {} -> {}", difference.before, difference.after);
    case Part::option:
      if (difference.name.starts_with(kDependsOption))
        return fmt::format("{} {}", difference.name.substr(kDependsOption.size()), fate(difference));
      return fmt::format("{} {} -> {}", option_path(project.rule(job), difference.name),
                         or_none(difference.before), or_none(difference.after));
    case Part::seed:
      return fmt::format("seed {} -> {}", without_unit(difference.before), without_unit(difference.after));
    case Part::input:
      if (!project.rule(job).gathers && !input_named(project, job, difference.name))
        return file_text(difference.name, difference);
      return fmt::format("{}{} {}", input_named(project, job, difference.name) ? "input " : "",
                         difference.name, fate(difference));
    case Part::part:
      if (difference.name.starts_with("package "))
        return fmt::format("{} {} -> {}", difference.name, or_none(difference.before),
                           or_none(difference.after));
      return fmt::format("{} {}: {}", project.rule(job).parts_of, fate(difference), difference.name);
    default:
      return "options or inputs in another order";
  }
}

// Counts gathered inputs by their fate: "3 map.LS changed, 1 map.LS added".
std::vector<std::string> group_texts(const Project& project, const Job& job,
                                     const std::vector<RecipeDifference>& differences) {
  const Rule& rule = project.rule(job);
  std::vector<std::string> parts;
  std::map<std::string, std::size_t> members;
  for (const RecipeDifference& difference : differences)
    if (rule.gathers && difference.part == Part::input)
      ++members[fate(difference)];
    else
      parts.push_back(group_text(project, job, difference));
  for (const auto& [what, n] : members)
    parts.push_back(fmt::format("{} {} {}", n, project.rules[rule.inputs[0]].stage, what));
  return parts;
}

std::string_view words_of(Reason reason) {
  constexpr std::array<std::string_view, 12> kWords = {"",
                                                       "not in the cache",
                                                       "options, inputs, seed or version changed",
                                                       "waits for",
                                                       "failed input:",
                                                       "no ground truth",
                                                       "not given",
                                                       "a source file cannot be read",
                                                       "damaged",
                                                       "does not apply",
                                                       "not asked for",
                                                       "needs the mean over all shards"};
  return kWords.at(static_cast<std::size_t>(reason));
}

// One line for one job, with the first cause of what it waits for and of inputs that changed.
std::string why_line(Causes& causes, const Job& job, const Cause& cause);

// From job to job, to the first that waits for nothing.
std::string waiting_line(Causes& causes, const Job& job) {
  const Project& project = causes.project();
  const std::vector<Job> awaited = causes.awaited(job);
  if (awaited.empty()) return std::string(words_of(Reason::changed));
  const Job& first = awaited[0];
  std::string text = "waits for " + project.rule(first).stage;
  if (first.unit.level == kRoot) return text + ", " + why_line(causes, first, causes.of(first));
  if (first.unit != job.unit) text += " of " + project.name(first);
  if (awaited.size() > 1) text += fmt::format(" and {} more", awaited.size() - 1);
  const bool goes_on = !project.rule(job).gathers && causes.of(first).reason == Reason::input_pending;
  return text + (goes_on ? ", " : ": ") + why_line(causes, first, causes.of(first));
}

std::string difference_line(Causes& causes, const Job& job, const RecipeDifference& difference) {
  const Project& project = causes.project();
  if (difference.part == Part::seed)
    return fmt::format("seed {} -> {}", or_none(difference.before), or_none(difference.after));
  if (difference.part != Part::input) return group_text(project, job, difference);
  if (project.rule(job).gathers) return fmt::format("that of {} {}", difference.name, fate(difference));
  const std::optional<Job> input = input_named(project, job, difference.name);
  if (!input) return file_text(source_text(project.files(job), difference.name), difference);
  std::vector<std::string> origin;
  if (project.rule(*input).given)
    origin.emplace_back("given by --reference");
  else
    for (const RecipeDifference& earlier : causes.since(*input, difference.before))
      origin.push_back(difference_line(causes, *input, earlier));
  return group_text(project, job, difference) + (origin.empty() ? "" : fmt::format(" ({})", joined(origin)));
}

std::string counted_line(Causes& causes, const Job& job) {
  const Decision& decision = causes.plan()[job];
  if (decision.known() && !decision.computed()) return {};  // without looking for its file
  const Cause cause = causes.of(job);
  const Project& project = causes.project();
  if (cause.reason == Reason::input_pending || cause.reason == Reason::input_failed)
    return fmt::format("{} {}", words_of(cause.reason),
                       project.rules[project.rule(job).inputs[decision.blocking_input]].stage);
  if (cause.differences.empty()) return std::string(words_of(cause.reason));
  return joined(group_texts(project, job, cause.differences));
}

std::string why_line(Causes& causes, const Job& job, const Cause& cause) {
  switch (cause.reason) {
    case Reason::none:
      return {};
    case Reason::input_pending:
      return waiting_line(causes, job);
    case Reason::input_failed:
      return counted_line(causes, job);
    case Reason::never_computed:
      return "no artefact of this stage and item";
    case Reason::damaged:
      return fmt::format("{}: {}", cause.file.string(), cause.fault);
    case Reason::changed: {
      std::vector<std::string> lines;
      for (const RecipeDifference& difference : cause.differences)
        lines.push_back(difference_line(causes, job, difference));
      return joined(lines);
    }
    default:
      return std::string(words_of(cause.reason));
  }
}

// A mesh may be called "52_3", as the scan 3 of the mesh 52 is: it goes first.
Unit require_unit(const Project& project, const std::string& name) {
  for (const Level level : {kMeshes, kClouds, kScans})
    for (const Unit unit : project.units.of(level))
      if (project.units.name(unit) == name && !project.jobs_of(unit).empty()) return unit;
  throw ConfigError(
      fmt::format("explain: there is no item '{}'; a shape is named like its file (52), the scans of a mesh "
                  "52_0 to 52_11",
                  name));
}

std::vector<Job> require_jobs(const Project& project, const std::string& item, const std::string& stage) {
  std::vector<Job> jobs = project.jobs_of(require_unit(project, item));
  if (stage.empty()) return jobs;
  std::vector<std::string_view> known;
  for (const Job& job : jobs) known.push_back(project.rule(job).stage);
  std::erase_if(jobs, [&](const Job& job) { return project.rule(job).stage != stage; });
  if (!jobs.empty()) return jobs;
  throw ConfigError(
      fmt::format("explain: {} has no stage '{}'; {}", item, stage,
                  did_you_mean(stage, known, fmt::format("it has {}", fmt::join(known, ", ")))));
}

std::string state_of(const Decision& job, const Cause& cause) {
  if (cause.reason == Reason::damaged) return "damaged";
  if (job.known()) return "cached";
  if (!job.open()) return "not applicable";
  return job.waits() ? "waiting" : "to compute";
}

struct ExplainArguments : Arguments {
  std::string item, stage;
};

Json explanation_json(const Explanation& stage) {
  return {{"stage", stage.stage},
          {"state", stage.state},
          {"why", stage.why},
          {"file", stage.file.empty() ? std::nullopt : std::optional(stage.file)}};
}

ExitStatus print_explanation(const ExplainArguments& arguments) {
  const Setup setup(arguments, Pictures::cached);
  const FolderStore store(setup.cache, Access::read_only);
  const auto stages = explain(setup.project, store, setup.cache, arguments.item, arguments.stage);
  Table table{.columns = {"stage", arguments.item, "why"}, .rows = {}};
  for (const Explanation& stage : stages) table.rows.push_back({stage.stage, stage.state, stage.why});
  std::string text = aligned(table);
  if (const Explanation& first = stages.front(); !arguments.stage.empty() && !first.file.empty())
    text +=
        fmt::format("{}: {}\n", first.state == "to compute" ? "nearest" : "artefact", first.file.string());
  print_report(arguments.format, "explain",
               {{"item", arguments.item}, {"stages", list_of(stages, explanation_json)}}, text);
  return kAllDone;
}

}  // namespace

std::vector<Explanation> explain(const Project& project, const Index& index,
                                 const std::filesystem::path& cache, const std::string& item,
                                 const std::string& stage) {
  const std::vector<Job> jobs = require_jobs(project, item, stage);
  const Plan plan = make_plan_of(project, index, jobs);
  Causes causes(project, plan, cache);
  std::vector<Explanation> explanations;
  for (const Job& job : jobs) {
    const Cause cause = causes.of(job, true);
    explanations.push_back(
        {project.rule(job).stage, state_of(plan[job], cause), why_line(causes, job, cause), cause.file});
  }
  return explanations;
}

Why why_open(Causes& causes) {
  return [&causes](const Job& job) { return counted_line(causes, job); };
}

Why why_computed(Causes& causes) {
  return [&causes](const Job& job) { return causes.plan()[job].computed() ? counted_line(causes, job) : ""; };
}

Action explain_subcommand(CLI::App& program) {
  const auto arguments = std::make_shared<ExplainArguments>();
  CLI::App& app = add_subcommand(
      program, "explain", "tell of each artefact of an item whether it is cached, and if not what differs",
      {{"explain configs/shrec07.yaml 52_3 --data SchellingData", "what differs from what the cache has"},
       {"explain configs/shrec07.yaml 52 map.LS --data SchellingData", "one stage, and its artefact"}});
  add_planning(app, *arguments);
  app.add_option("ITEM", arguments->item, "a mesh or point cloud (52), or a scan of a mesh (52_3)")
      ->required();
  app.add_option("STAGE", arguments->stage, "this stage only");
  add_format(app, *arguments);
  return [arguments] { return print_explanation(*arguments); };
}

}  // namespace salbench
