// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/installed.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "pipeline/config/program_files.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Names without ending of the files beside it, and of those of the program.
std::vector<std::string> known_configurations(const fs::path& given) {
  std::vector<std::string> names;
  const fs::path folder = given.parent_path();
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, none))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  for (const NamedYaml& configuration : configurations())
    if (folder.empty() || fs::path(configuration.name).parent_path() == folder)
      names.emplace_back(configuration.name);
  std::ranges::sort(names);
  return names;
}

}  // namespace

Section configuration(const std::string& given) {
  std::error_code error;
  // A folder of that name, such as that of its results, is not meant.
  if (fs::exists(given, error) && !fs::is_directory(given, error)) return Section::from_file(given);
  for (const NamedYaml& configuration : configurations())
    if (given == configuration.name || given == std::string(configuration.name) + ".yaml")
      return Section::from_text(std::string(configuration.yaml), std::string(configuration.name) + ".yaml");
  const std::vector<std::string> known = known_configurations(given);
  const bool of_protocol = given.starts_with("protocols/");
  const std::string hint = did_you_mean((of_protocol ? "protocols/" : "") + fs::path(given).stem().string(),
                                        {known.begin(), known.end()});
  if (hint.empty()) return Section::from_file(given);  // which says why it cannot be read
  throw ConfigError(fmt::format("{}: cannot be read: there is no such configuration; {}", given, hint));
}

}  // namespace salbench
