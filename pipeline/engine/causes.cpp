// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/causes.h"

#include <utility>

namespace salbench {

Causes::Causes(const Project& project, const Plan& plan, std::filesystem::path cache, std::size_t limit)
    : project_(project), plan_(plan), book_(std::move(cache)), limit_(limit) {}

const Recipe* Causes::read(const ArtefactFile& file) {
  const auto known = recipes_.find(file.path);
  if (known != recipes_.end()) return known->second ? &*known->second : nullptr;
  ++opened_[file.stage];
  const auto& recipe = recipes_.emplace(file.path, read_recipe(file).recipe).first->second;
  return recipe ? &*recipe : nullptr;
}

Cause Causes::of(const Job& job, bool verify) {
  const Decision& decision = plan_[job];
  const bool hit = decision.verdict == Verdict::cached;
  if (project_.rule(job).given) return {};
  if (decision.verdict == Verdict::wait ||
      (!hit && !decision.known() && decision.verdict != Verdict::compute) ||
      decision.reason == Reason::unreadable)
    return {decision.reason};
  const Recipe now = recipe_of(project_, plan_, job);
  const Digest key = key_of(now);

  const std::filesystem::path* aside = book_.quarantined(key);
  if (aside != nullptr && (!hit || decision.reason == Reason::damaged))
    return {Reason::damaged, {}, *aside, "a run moved it aside"};
  if (hit || decision.verdict == Verdict::compute) {
    for (const ArtefactFile& file : book_.artefacts(now.stage, key)) {
      if (hit && !verify) return {decision.reason, {}, file.path};
      if (std::string fault = read_recipe(file).fault; !fault.empty())
        return {Reason::damaged, {}, file.path, std::move(fault)};
      if (hit) return {Reason::none, {}, file.path};
    }
    if (hit) return {decision.reason};
  }
  return nearest(book_.artefacts(now.stage, project_.name(job)), now, key);
}

Cause Causes::nearest(const std::vector<ArtefactFile>& files, const Recipe& now, const Digest& key) {
  Cause nearest{Reason::never_computed};
  for (const ArtefactFile& file : files) {
    if (file.name.key == key) continue;
    if (opened_[file.stage] >= limit_) return {Reason::changed};
    const Recipe* recipe = read(file);
    if (recipe == nullptr) continue;
    auto found = differences(*recipe, now);
    if (nearest.reason == Reason::never_computed || found.size() < nearest.differences.size())
      nearest = {Reason::changed, std::move(found), file.path};
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
  for (const ArtefactFile& file : book_.artefacts(project_.rule(job).stage, project_.name(job)))
    if (content && file.name.content == *content)
      if (const Recipe* earlier = read(file)) return differences(*earlier, recipe_of(project_, plan_, job));
  return {};
}

}  // namespace salbench
