// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/maintain.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pipeline/engine/resolver.h"
#include "stages/core/errors.h"

namespace salbench {

std::size_t add_needed(const Project& project, const Plan& plan, KeepSet& needed) {
  std::size_t unknown = 0;
  for (const Job& job : project.jobs()) {
    const Decision& decision = plan[job];
    const Rule& rule = project.rule(job);
    if (rule.given || decision.state == State::not_applicable) continue;
    if (decision.key == Digest()) {
      needed.add_every_key(rule.stage, project.name(job));
      ++unknown;
    } else {
      needed.add(decision.key);  // open jobs too: another process may store them
    }
  }
  return unknown;
}

namespace {

// Recomputes a cached job and describes the first difference; empty if there is none.
std::string recomputed_fault(const Project& project, Resolver& resolver, const Job& job) try {
  const Digest content = content_digest(project.rule(job).arrays(*resolver.recompute(job)));
  if (content == resolver.plan()[job].content) return {};
  return fmt::format(
      "computed again, its content is {}: the {}, or its version was not raised", content.hex(),
      project.rule(job).is_foreign ? "model gives another map each time" : "stage is not deterministic");
} catch (const InputError& error) {
  return fmt::format("cannot be computed again: {}", error.what());
} catch (const StorageError&) {
  throw;
} catch (...) {
  return current_defect();
}

// nullopt if the file is damaged
std::optional<FolderStore::Location> place_of(const FolderStore& store, const Digest& key) try {
  return store.location(key);
} catch (const InputError&) {
  return {};
}

}  // namespace

Recomputation recompute_sample(const Project& project, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop) {
  std::vector<Job> jobs = project.jobs();
  std::erase_if(jobs, [&](const Job& job) { return !plan[job].known() || project.rule(job).given; });
  Rng rng(project.seed, "verify", "");
  Resolver resolver(project, plan, store, Resolver::Damaged::report);
  Recomputation result;
  for (std::size_t i = 0; i < std::min(sample, jobs.size()) && !stop; ++i) {
    std::swap(jobs[i], jobs[i + rng.below(jobs.size() - i)]);
    const auto place = place_of(store, plan[jobs[i]].key);
    std::string fault = recomputed_fault(project, resolver, jobs[i]);
    resolver.forget_all();
    if (!fault.empty())
      result.faults.push_back(
          {place ? place->file / place->group : std::filesystem::path(project.rule(jobs[i]).stage),
           std::move(fault)});
    ++result.jobs;
  }
  return result;
}

}  // namespace salbench
