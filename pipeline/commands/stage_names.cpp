// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/stage_names.h"

#include <fmt/format.h>

#include "pipeline/inputs/inputs.h"
#include "stages/core/errors.h"

namespace salbench {

StageNames selected_stages(const std::string& list, const std::vector<std::string>& known) {
  const std::vector<std::string> wanted = split_list(list);
  if (wanted.empty()) return {known.begin(), known.end()};
  StageNames selected;
  for (const std::string& part : wanted) {
    bool found = false;
    for (const std::string& stage : known) {
      if (stage != part && !stage.starts_with(part + ".")) continue;
      selected.insert(stage);
      found = true;
    }
    if (!found)
      throw ConfigError(fmt::format("--stage {}: there is no stage '{}'; there are {}", list, part,
                                    fmt::join(known, ", ")));
  }
  return selected;
}

}  // namespace salbench
