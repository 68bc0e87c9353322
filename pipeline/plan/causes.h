// SPDX-License-Identifier: GPL-3.0-or-later
// Why a job is not simply a hit, down to the component of its key: compared with the nearest artefact in the
// cache, the one of the same row and item with the fewest components that differ. Changes nothing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cache/recipes.h"
#include "pipeline/plan/plan.h"

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

  // The references must outlive it. At most `limit` artefacts per stage are opened; jobs beyond are `changed`
  // without differences.
  Causes(const Context& context, const Plan& plan, std::filesystem::path cache, std::size_t limit = kNoLimit);

  // Before a run or after it: of what was computed, why. With `verify`, hits are read and checked too.
  Cause of(const JobRef& job, bool verify = false);

  // One line for one job: "fpfh.radius 0.02 -> 0.03", "mesh file 52.off changed", with the first cause of
  // what it waits for and of inputs that changed.
  std::string line(const JobRef& job, const Cause& cause);

  // The same words for every job with the same cause, to be counted.
  std::string group(const JobRef& job);
  Why words();              // while this lives
  Why words_of_computed();  // after a run: nothing for jobs that it found or left

 private:
  std::string waits(const JobRef& job);
  std::string waits_for_members(const JobRef& job);
  std::string origin(const JobRef& input, const std::string& content_before);
  std::string difference_line(const JobRef& job, const RecipeDifference& difference);
  Cause nearest(const std::vector<ArtefactFile>& files, const Recipe& now, const Digest& key);
  const Recipe* read(const ArtefactFile& file);

  const Context& context_;
  const Plan& plan_;
  RecipeBook book_;
  std::size_t limit_;
  std::map<std::string, std::size_t> opened_;                       // by stage
  std::map<std::filesystem::path, std::optional<Recipe>> recipes_;  // read so far; nothing for unsound files
};

inline constexpr std::size_t kOpenedForCounting = 300;  // artefacts per stage, where causes are only counted

}  // namespace salbench
