// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/causes.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace salbench {

namespace {

// The parts that differ, in place of what is made of them.
void name_parts(std::vector<RecipeDifference>& found, const Rule& rule, const KnownArtefact& before) {
  if (before.parts.empty() || rule.parts.empty()) return;
  const auto whole = std::ranges::find(found, rule.parts_of, &RecipeDifference::name);
  if (whole == found.end()) return;
  const auto parts = differences_of_parts(before.parts, rule.parts);
  if (parts.empty()) return;
  found.insert(found.erase(whole), parts.begin(), parts.end());
}

}  // namespace

Causes::Causes(const Project& project, const Plan& plan, std::filesystem::path cache, std::size_t limit)
    : project_(project), plan_(plan), book_(std::move(cache)), limit_(limit) {}

std::vector<KnownArtefact> Causes::known(const Job& job) {
  return book_.find(project_.family(job), project_.rule(job).stage, project_.name(job), plan_[job].key);
}

Cause Causes::of(const Job& job, bool verify) {
  const Decision& decision = plan_[job];
  const bool restored = decision.known() && decision.reason == Reason::damaged;
  const bool hit = restored || (decision.known() && !decision.computed());
  if (project_.rule(job).given) return {};
  if ((!decision.known() && !decision.open()) || decision.waits() || decision.reason == Reason::unreadable)
    return {decision.reason};
  if (book_.read() >= limit_ && !book_.has_read(project_.family(job))) return {decision.reason};
  const std::vector<KnownArtefact> artefacts = known(job);
  Cause damaged;
  for (const KnownArtefact& artefact : artefacts) {
    if (artefact.key != decision.key || (decision.known() && !hit)) continue;
    if (hit && !verify) return {decision.reason, {}, artefact.file};
    std::string fault = fault_of(artefact);
    if (fault.empty()) return {decision.reason, {}, artefact.file};
    damaged = {Reason::damaged, {}, artefact.file, std::move(fault)};
  }
  if (damaged.reason == Reason::damaged) return damaged;
  return hit ? Cause{decision.reason} : nearest(artefacts, job);
}

Cause Causes::nearest(const std::vector<KnownArtefact>& known, const Job& job) const {
  const Recipe now = recipe_of(project_, plan_, job);
  Cause nearest{Reason::never_computed};
  // Of those that differ in as much, the one of the least key: files come in any order.
  std::tuple<std::size_t, std::size_t, Digest> least;
  for (const KnownArtefact& artefact : known) {
    if (artefact.key == plan_[job].key || !artefact.recipe) continue;
    auto found = differences(*artefact.recipe, now);
    const std::size_t differing = found.size();
    name_parts(found, project_.rule(job), artefact);
    const std::tuple rank{differing, found.size(), artefact.key};
    if (nearest.reason == Reason::never_computed || rank < least) {
      nearest = {Reason::changed, std::move(found), artefact.file};
      least = rank;
    }
  }
  return nearest;
}

std::vector<Job> Causes::awaited(const Job& job) const {
  if (plan_[job].reason != Reason::input_pending) return {};
  if (!project_.rule(job).gathers) return {project_.input_job(job, plan_[job].blocking_input)};
  std::vector<Job> open;
  for (const Job& member : project_.input_jobs(job, 0))
    if (plan_[member].open()) open.push_back(member);
  return open;
}

std::vector<RecipeDifference> Causes::since(const Job& job, const std::string& content_before) {
  const auto content = digest_from_hex(content_before);
  for (const KnownArtefact& artefact : known(job))
    if (content && artefact.recipe && artefact.content == *content) {
      auto found = differences(*artefact.recipe, recipe_of(project_, plan_, job));
      name_parts(found, project_.rule(job), artefact);
      return found;
    }
  return {};
}

}  // namespace salbench
