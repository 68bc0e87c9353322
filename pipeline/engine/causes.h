// SPDX-License-Identifier: GPL-3.0-or-later
// Explains: why a job is not simply a hit, down to the component of its key, compared with the nearest
// artefact in the cache, the one of the same stage and unit with the fewest components that differ. Changes
// nothing, and makes data; words for them are made where they are shown.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cache/recipes.h"
#include "pipeline/engine/plan.h"

namespace salbench {

struct Cause {
  Reason reason = Reason::none;                    // none: a hit
  std::vector<RecipeDifference> differences = {};  // where changed: from the nearest artefact to the job
  std::filesystem::path file = {};                 // the nearest artefact, or the damaged one, or the hit
  std::string fault = {};                          // where damaged
};

class Causes {
 public:
  static constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

  // The references must outlive it. Once the recipes of `limit` artefacts are read, jobs of further families
  // have the plan's reasons, without differences.
  Causes(const Project& project, const Plan& plan, std::filesystem::path cache, std::size_t limit = kNoLimit);

  const Project& project() const { return project_; }
  const Plan& plan() const { return plan_; }

  // Before a run or after it: of what was computed, why. With `verify`, hits are read and checked too.
  Cause of(const Job& job, bool verify = false);

  // The jobs that a job waits for, the first one in front; none where it does not wait.
  std::vector<Job> awaited(const Job& job) const;

  // How the earlier artefact of a job, known by its content, was made otherwise than the present one.
  std::vector<RecipeDifference> since(const Job& job, const std::string& content_before);

 private:
  Cause nearest(const std::vector<KnownArtefact>& known, const Job& job) const;
  std::vector<KnownArtefact> known(const Job& job);

  const Project& project_;
  const Plan& plan_;
  RecipeBook book_;
  std::size_t limit_;
};

inline constexpr std::size_t kOpenedForCounting = 10'000;  // artefacts, where causes are only counted

}  // namespace salbench
