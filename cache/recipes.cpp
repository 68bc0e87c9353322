// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/recipes.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "cache/verify.h"
#include "io/file.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

using Lines = std::vector<std::pair<std::string, std::string>>;  // "name: value"

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = std::min(line.find(": "), line.size());
    lines.emplace_back(line.substr(0, colon), line.substr(std::min(colon + 2, line.size())));
  }
  return lines;
}

Lines lines_of(const std::vector<std::pair<std::string, Digest>>& inputs) {
  Lines lines;
  for (const auto& [name, digest] : inputs) lines.emplace_back(name, digest.hex());
  return lines;
}

// nullptr if there is none.
const std::string* value_of(const Lines& lines, const std::string& name) {
  for (const auto& [key, value] : lines)
    if (key == name) return &value;
  return nullptr;
}

void compare(RecipeDifference::Part part, const Lines& before, const Lines& after,
             std::vector<RecipeDifference>& found) {
  const std::size_t known = found.size();
  for (const auto& [name, value] : after) {
    const std::string* old = value_of(before, name);
    if (old == nullptr || *old != value) found.push_back({part, name, old == nullptr ? "" : *old, value});
  }
  for (const auto& [name, value] : before)
    if (value_of(after, name) == nullptr) found.push_back({part, name, value, ""});
  if (found.size() == known && before != after) found.push_back({RecipeDifference::Part::order, "", "", ""});
}

}  // namespace

std::vector<RecipeDifference> differences(const Recipe& before, const Recipe& after) {
  using Part = RecipeDifference::Part;
  std::vector<RecipeDifference> found;
  if (before.stage_version != after.stage_version)
    found.push_back(
        {Part::version, "", std::to_string(before.stage_version), std::to_string(after.stage_version)});
  compare(Part::option, lines_of(before.options), lines_of(after.options), found);
  if (before.seed != after.seed) found.push_back({Part::seed, "", before.seed, after.seed});
  compare(Part::input, lines_of(before.inputs), lines_of(after.inputs), found);
  return found;
}

RecipeReading read_recipe(const ArtefactFile& file) {
  const auto bytes = read_bytes(file.path);
  if (!bytes) return {{}, "gone"};
  const Inspection inspection = inspect_artefact(*bytes, file.stage, file.name);
  if (!inspection.content) return {{}, inspection.fault};
  return {recipe_from(inspection.content->attributes), {}};
}

RecipeBook::RecipeBook(fs::path folder) : folder_(std::move(folder)) {
  for (FolderEntry& entry : list_folder(folder_ / kDamagedFolder))
    if (const auto name = parse_artefact_name(entry.path.filename().native()))
      quarantined_.emplace(name->key, std::move(entry.path));
}

ArtefactFile RecipeBook::located(const std::string& stage, ArtefactName name) const {
  return {folder_ / shard_of(stage, name.key) / name.text(), stage, std::move(name)};
}

std::vector<ArtefactFile> RecipeBook::artefacts(const std::string& stage, std::string_view item) {
  if (std::exchange(stage_, stage) != stage) {
    files_.clear();
    for (std::size_t shard = 0; shard < kShards; ++shard)
      visit_names(folder_ / shard_of(stage, first_key(shard)),
                  [&](std::string_view file, bool) { files_.emplace_back(file); });
    std::ranges::sort(files_);
  }
  std::vector<ArtefactFile> found;
  const std::string begin = item_label(item) + '.';
  for (auto file = std::ranges::lower_bound(files_, begin); file != files_.end() && file->starts_with(begin);
       ++file)
    if (auto name = parse_artefact_name(*file)) found.push_back(located(stage, std::move(*name)));
  return found;
}

std::vector<ArtefactFile> RecipeBook::artefacts(const std::string& stage, const Digest& key) const {
  std::vector<ArtefactFile> found;
  for (ArtefactName& name : find_artefacts(folder_, stage, key))
    found.push_back(located(stage, std::move(name)));
  return found;
}

const fs::path* RecipeBook::quarantined(const Digest& key) const {
  const auto found = quarantined_.find(key);
  return found == quarantined_.end() ? nullptr : &found->second;
}

}  // namespace salbench
