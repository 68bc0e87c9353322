// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "stages/core/parallel.h"

namespace salbench {
namespace {

constexpr std::size_t kUnitGrain = 8;  // units of a rule per task

Decision without_key(State state, Reason reason, std::size_t blocking_input = 0) {
  return {state, reason, static_cast<std::uint8_t>(blocking_input)};
}

// Decision inherited from an input without a known result; nullopt if the input is known.
std::optional<Decision> stopped_by(const Decision& input, std::size_t index) {
  if (input.known()) return {};
  return without_key(input.state,
                     input.open()                   ? Reason::input_pending
                     : input.state == State::failed ? Reason::input_failed
                                                    : input.reason,
                     index);
}

// An inapplicable input takes precedence over a pending one: waiting would be in vain.
std::optional<Decision> stopped_by_inputs(const Project& project, const Plan& plan, const Job& job) {
  std::optional<Decision> stopped;
  for (std::size_t i = 0; i < project.rule(job).inputs.size(); ++i) {
    const std::optional<Decision> by_this = stopped_by(plan[project.input_job(job, i)], i);
    if (by_this && (!stopped || by_this->state == State::not_applicable)) stopped = by_this;
  }
  return stopped;
}

// Failed and inapplicable units are left out: one bad file must not stop the whole.
std::optional<Decision> stopped_by_members(const Project& project, const Plan& plan, const Job& job) {
  if (project.is_share) return without_key(State::not_applicable, Reason::needs_all);
  bool any_known = false;
  for (const Job& member : project.input_jobs(job, 0)) {
    if (plan[member].open()) return without_key(State::open, Reason::input_pending);
    any_known |= plan[member].known();
  }
  if (any_known) return {};
  return without_key(State::not_applicable, Reason::no_files);
}

std::optional<Decision> stopped_by_files(const Project& project, const Job& job) {
  const Rule& rule = project.rule(job);
  if (rule.files == nullptr) return {};
  const std::span<File> files = project.files(job);
  if (files.empty())
    return without_key(State::not_applicable, rule.files_expected ? Reason::no_files : Reason::not_given);
  if (std::ranges::all_of(files, [](File& file) { return file.digest().has_value(); })) return {};
  return without_key(State::open, Reason::unreadable);
}

// Decision for a job that cannot be looked up; nullopt if its recipe is complete.
std::optional<Decision> stopped(const Project& project, const Plan& plan, const Job& job) {
  const Rule& rule = project.rule(job);
  if (rule.applies && !rule.applies(project.units.source_of(job.unit).source))
    return without_key(State::not_applicable, Reason::inapplicable);
  if (rule.gathers) return stopped_by_members(project, plan, job);
  if (const auto by_input = stopped_by_inputs(project, plan, job)) return by_input;
  return stopped_by_files(project, job);
}

// True if this run has rules of that stage with the same options: which results are found would then depend
// on the order of jobs.
bool is_in_run(const Project& project, const Rule& rule, const std::string& stage) {
  const auto keyed = [](const Rule& of) {
    std::string text;
    for (const OptionLines& options : of.options) text += options.in_key;
    return text;
  };
  return std::ranges::any_of(project.rules, [&](const Rule& other) {
    return other.stage == stage && other.version == rule.version && keyed(other) == keyed(rule);
  });
}

// Decides rule by rule; `jobs_of` lists the jobs of each.
template <class JobsOf>
Plan decide_all(const Project& project, const Index& index, const JobsOf& jobs_of) {
  Plan plan;
  for (const Rule& rule : project.rules)
    plan.decisions.emplace_back(project.units.slots(rule.level()),
                                without_key(State::not_applicable, Reason::none));
  for (std::size_t r = 0; r < project.rules.size(); ++r) {
    const std::vector<Job> jobs = jobs_of(r);
    parallel_ranges(jobs.size(), kUnitGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        Decision decision = decide(project, plan, jobs[i], index);
        if (decision.reason == Reason::never_computed &&
            index.has_item(project.rule(jobs[i]).stage, project.name(jobs[i])))
          decision.reason = Reason::changed;
        plan[jobs[i]] = decision;
      }
    });
  }
  return plan;
}

}  // namespace

std::string Project::name(const Job& job) const {
  return rule(job).gathers ? std::string(units.levels()[rule(job).over].units) : units.name(job.unit);
}

std::string Project::family(const Job& job) const {
  return job.unit.level == kRoot ? std::string() : units.source_of(job.unit).name;
}

std::vector<Job> Project::jobs_of(Unit unit) const {
  std::vector<Job> jobs;
  for (std::size_t r = 0; r < rules.size(); ++r)
    if (rules[r].level() == unit.level && (rules[r].for_all || units.is_chosen(unit)))
      jobs.push_back({r, unit});
  return jobs;
}

std::vector<Job> Project::jobs_of_rule(std::size_t rule) const {
  std::vector<Job> jobs;
  for (const Unit unit : units_of(rule)) jobs.push_back({rule, unit});
  return jobs;
}

std::vector<Job> Project::jobs() const {
  std::vector<Job> jobs;
  for (std::size_t rule = 0; rule < rules.size(); ++rule)
    for (const Job& job : jobs_of_rule(rule)) jobs.push_back(job);
  return jobs;
}

Job Project::input_job(const Job& job, std::size_t input) const {
  const std::size_t read = rule(job).inputs[input];
  return {read, units.above(job.unit, rules[read].level())};
}

std::vector<Job> Project::input_jobs(const Job& job, std::size_t input) const {
  return rule(job).gathers ? jobs_of_rule(rule(job).inputs[input]) : std::vector{input_job(job, input)};
}

std::span<File> Project::files(const Job& job) const {
  const FilesOfUnits& files = rule(job).files;
  return files == nullptr ? std::span<File>() : files->at(job.unit.index);
}

std::vector<bool> Project::ancestors(const std::vector<std::size_t>& rules_given) const {
  std::vector<bool> needed(rules.size(), false);
  for (const std::size_t rule : rules_given) needed[rule] = true;
  for (std::size_t rule = needed.size(); rule-- > 0;)
    if (needed[rule] && !rules[rule].given)
      for (const std::size_t input : rules[rule].inputs) needed[input] = true;
  return needed;
}

std::size_t Plan::open(std::size_t rule) const {
  return static_cast<std::size_t>(std::count_if(decisions[rule].begin(), decisions[rule].end(),
                                                [](const Decision& decision) { return decision.open(); }));
}

Recipe recipe_of(const Project& project, const Plan& plan, const Job& job) {
  const Rule& rule = project.rule(job);
  Recipe recipe{rule.stage, rule.version, {}, {}, {}};
  for (const OptionLines& options : rule.options) recipe.options += options.in_key;
  if (rule.placed)
    recipe.options +=
        fmt::format("{}: {}\n", project.units.levels()[rule.over].place, project.units.place(job.unit));
  if (rule.seeded) recipe.seed = fmt::format("{}/{}", project.seed, project.name(job));
  for (std::size_t i = 0; i < rule.inputs.size(); ++i)
    if (!rule.gathers)
      recipe.inputs.emplace_back(project.rules[rule.inputs[i]].stage,
                                 plan[project.input_job(job, i)].content);
    else
      for (const Job& member : project.input_jobs(job, i))
        if (plan[member].known()) recipe.inputs.emplace_back(project.name(member), plan[member].content);
  for (File& file : project.files(job))
    if (const auto digest = file.digest()) recipe.inputs.emplace_back(file.name, *digest);
  if (const auto text = rule.text.in(job.unit))
    recipe.inputs.emplace_back(rule.text.name, file_digest(*text));
  return recipe;
}

std::vector<Recipe> renamed_recipes_of(const Project& project, const Plan& plan, const Job& job,
                                       const Index& index) {
  std::vector<Recipe> recipes;
  const Rule& rule = project.rule(job);
  if (!rule.is_foreign && rule.same_as.empty()) return recipes;
  Recipe renamed = recipe_of(project, plan, job);
  if (!rule.is_foreign) {
    renamed.stage = rule.same_as;
    if (!is_in_run(project, rule, rule.same_as)) recipes.push_back(renamed);
    return recipes;
  }
  const std::string_view role =
      std::string_view(rule.stage).substr(0, rule.stage.size() - rule.subject.size());
  for (std::string& stage : index.stages()) {
    if (stage == rule.stage || !stage.starts_with(role) || is_in_run(project, rule, stage)) continue;
    renamed.stage = std::move(stage);
    recipes.push_back(renamed);
  }
  return recipes;
}

Decision decide(const Project& project, const Plan& plan, const Job& job, const Index& index) {
  if (const ValuePtr& given = project.rule(job).given) {
    Decision known = without_key(State::known, Reason::none);
    known.content = content_digest(project.rule(job).arrays(*given));
    return known;
  }
  if (const auto no_key = stopped(project, plan, job)) return *no_key;
  Decision decided = without_key(State::open, Reason::never_computed);
  decided.key = key_of(recipe_of(project, plan, job));
  const auto find = [&](const Digest& key) {
    if (const auto content = index.find(key)) decided = {State::known, Reason::none, 0, key, *content};
    return decided.known();
  };
  if (find(decided.key)) return decided;
  for (const Recipe& renamed : renamed_recipes_of(project, plan, job, index))
    if (find(key_of(renamed))) return decided;
  if (project.rule(job).only_if_cached) return without_key(State::not_applicable, Reason::only_cached);
  return decided;
}

Plan make_plan(const Project& project, const Index& index) {
  return decide_all(project, index, [&](std::size_t rule) { return project.jobs_of_rule(rule); });
}

Plan make_plan_of(const Project& project, const Index& index, const std::vector<Job>& jobs) {
  std::vector<std::vector<Job>> needed(project.rules.size());
  for (const Job& job : jobs) needed[job.rule].push_back(job);
  for (std::size_t r = needed.size(); r-- > 0;) {
    std::ranges::sort(needed[r]);
    needed[r].erase(std::unique(needed[r].begin(), needed[r].end()), needed[r].end());
    for (const Job& job : needed[r])
      for (std::size_t i = 0; i < project.rules[r].inputs.size() && !project.rules[r].given; ++i)
        for (const Job& input : project.input_jobs(job, i)) needed[input.rule].push_back(input);
  }
  return decide_all(project, index, [&](std::size_t rule) { return needed[rule]; });
}

}  // namespace salbench
