#include "cache/recipes.h"

#include <algorithm>
#include <sstream>

#include "cache/files.h"
#include "cache/verify.h"

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
  if (!bytes) return {{}, "gone or unreadable"};
  const Inspection inspection = inspect_artefact(*bytes, file.stage, file.name);
  if (!inspection.content) return {{}, inspection.fault};
  return {recipe_from(inspection.content->attributes), {}};
}

RecipeBook::RecipeBook(fs::path folder) : folder_(std::move(folder)) {
  std::error_code not_there;
  for (const auto& entry : fs::directory_iterator(folder_ / kDamagedFolder, not_there))
    if (const auto name = parse_artefact_name(entry.path().filename().string()))
      set_aside_.emplace(name->key, entry.path());
}

const std::vector<ArtefactFile>& RecipeBook::artefacts(const std::string& stage, std::string_view item) {
  static const std::vector<ArtefactFile> none;
  const auto [listed, fresh] = stages_.try_emplace(stage);
  ByItem& by_item = listed->second;
  if (fresh) {
    std::error_code not_there;
    for (const auto& shard : fs::directory_iterator(folder_ / stage, not_there))
      for (const auto& entry : fs::directory_iterator(shard.path(), not_there))
        if (const auto name = parse_artefact_name(entry.path().filename().string()))
          by_item[name->item].push_back({entry.path(), stage, *name});
    for (auto& [label, files] : by_item)
      std::sort(files.begin(), files.end(),
                [](const ArtefactFile& a, const ArtefactFile& b) { return a.path < b.path; });
  }
  const auto found = by_item.find(item_label(item));
  return found == by_item.end() ? none : found->second;
}

const fs::path* RecipeBook::set_aside(const Digest& key) const {
  const auto found = set_aside_.find(key);
  return found == set_aside_.end() ? nullptr : &found->second;
}

}  // namespace salbench
