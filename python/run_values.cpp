// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/run_values.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/rules/values.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench::python {
namespace {

// Job of this role on a shape, and of `model` (empty for roles without one); nullopt if the run has none.
// Throws InputError if two shapes share the name.
std::optional<Job> job_of(const Project& project, Role role, const std::string& model,
                          const std::string& item) {
  std::optional<Job> found;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule) {
    if (!has_role(project.rules[rule], role) || project.rules[rule].subject != model) continue;
    for (const Unit unit : project.units.of(project.rules[rule].over)) {
      if (project.units.name(unit) != item) continue;
      if (found)
        throw InputError(
            fmt::format("two shapes of the run are called '{}': rename one, or leave it out", item));
      found = Job{rule, unit};
    }
  }
  return found;
}

// Names of the shapes whose map jobs satisfy `is`, in the order of the data set.
template <class Is>
std::vector<std::string> names_where(const Project& project, const Is& is) {
  std::vector<Unit> units;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    if (has_role(project.rules[rule], Role::map))
      for (const Unit unit : project.units.of(project.rules[rule].over))
        if (is(Job{rule, unit})) units.push_back(unit);
  std::ranges::sort(units, {}, [&](Unit unit) { return std::pair(project.units.family_of(unit), unit); });
  units.erase(std::unique(units.begin(), units.end()), units.end());
  std::vector<std::string> names;
  for (const Unit unit : units) names.push_back(project.units.name(unit));
  return names;
}

ValuePtr known_value(Session& session, const std::optional<Job>& job) {
  return job && session.resolver.plan()[*job].known() ? session.resolver.value(*job) : nullptr;
}

// Model whose map of the shape equals `map`; the first model if there is none.
std::string owner_of(Session& session, const ScalarField& map, const std::string& item) {
  const std::vector<std::string> models = models_with_maps(session.setup.project);
  for (const std::string& model : models)
    if (const ValuePtr own = map_of(session, model, item); own && value_as<ScalarField>(*own) == map)
      return model;
  return models.empty() ? std::string() : models.front();
}

// Result of a model's job with another map in place of its own; other rules keep their results.
ValuePtr with_map(Session& session, const Job& job, const Job& map_job, const ValuePtr& map) {
  const Project& project = session.setup.project;
  const Rule& rule = project.rule(job);
  if (job == map_job) return map;
  if (rule.subject != project.rule(map_job).subject || rule.gathers) {
    if (const ValuePtr value = known_value(session, job)) return value;
    throw InputError(
        fmt::format("{}: the run has no scores of it: there is no {}", project.name(map_job), rule.stage));
  }
  JobInputs inputs{.random = {project.seed, project.name(job)}};
  for (std::size_t i = 0; i < rule.inputs.size(); ++i)
    inputs.values.push_back(with_map(session, project.input_job(job, i), map_job, map));
  return rule.compute(inputs);
}

}  // namespace

std::vector<std::string> models_with_maps(const Project& project) {
  std::vector<std::string> models;
  for (const Rule& rule : project.rules)
    if (has_role(rule, Role::map) && std::ranges::find(models, rule.subject) == models.end())
      models.push_back(rule.subject);
  return models;
}

std::vector<std::string> shapes_with_maps(const Project& project) {
  return names_where(project, [](const Job&) { return true; });
}

std::vector<std::string> mapped_items(const Session& session, const std::string& model) {
  return names_where(session.setup.project, [&](const Job& job) {
    return session.setup.project.rule(job).subject == model && session.resolver.plan()[job].known();
  });
}

ValuePtr map_of(Session& session, const std::string& model, const std::string& item) {
  return known_value(session, job_of(session.setup.project, Role::map, model, item));
}

std::optional<std::size_t> point_count(Session& session, const std::string& item) {
  const auto& rules = session.setup.project.rules;
  for (const Rule& rule : rules)
    if (has_role(rule, Role::map))
      if (const auto job = job_of(session.setup.project, Role::map, rule.subject, item))
        for (std::size_t shape = 0; shape < rules.size(); ++shape)
          if (has_role(rules[shape], Role::shape) && rules[shape].over == job->unit.level)
            if (const ValuePtr value = known_value(session, Job{shape, job->unit}))
              return points_in(*value).size();
  return {};
}

Scores scores_of(Session& session, const ScalarField& map, const std::string& item, std::string model) {
  require_finite(map, "prediction");
  if (model.empty()) model = owner_of(session, map, item);
  const Project& project = session.setup.project;
  const auto map_job = job_of(project, Role::map, model, item);
  const auto scores_job = job_of(project, Role::scores, model, item);
  if (!map_job || !scores_job) throw InputError(fmt::format("{}: {} has no map of it", item, model));
  return value_as<Scores>(*with_map(session, *scores_job, *map_job, held(map)));
}

}  // namespace salbench::python
