// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/maintain.h"

#include <fmt/format.h>

#include "cache/layout.h"
#include "pipeline/engine/maintain.h"
#include "pipeline/run/session.h"
#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;

CollectedCache collect(const CollectOptions& options, const Front& front, Progress& progress) {
  CollectedCache found{.cache = options.kept.empty() ? options.cache : "", .collected = {}};
  KeepSet needed;
  for (Request request : options.kept) {
    request.cache = options.cache.string();
    request.pictures = Pictures::cached;
    const Setup setup(request, front);
    if (!found.cache.empty() && fs::weakly_canonical(found.cache) != fs::weakly_canonical(setup.cache))
      throw ConfigError(fmt::format("{}: its cache is {}, not {}: clean one cache at a time", request.config,
                                    setup.cache.string(), found.cache.string()));
    found.cache = setup.cache;
    if (!options.stages.empty()) continue;
    const FolderStore store(found.cache, Access::read_only);
    found.waiting += add_needed(setup.project, make_plan(setup.project, store), needed);
  }
  if (!options.stages.empty()) {
    require_cache(found.cache);
    std::vector<std::string> known;
    for (const FolderStore::Usage& used : FolderStore(found.cache, Access::read_only).usage())
      known.push_back(used.stage);
    for (const std::string& stage : selected_stages(options.stages, known)) needed.drop(stage);
  }
  found.collected = collect_garbage(found.cache, needed, options.dry_run, progress);
  return found;
}

}  // namespace salbench
