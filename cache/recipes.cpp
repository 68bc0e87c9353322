// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/recipes.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

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

// `visit` gets segment and row. Skips a file whose head is damaged: its rows are not known.
template <class Visit>
void visit_rows(const std::filesystem::path& file, const Visit& visit) try {
  if (const std::optional<Segment> segment = Segment::open(file))
    for (const SegmentRow& row : segment->rows()) visit(*segment, row);
} catch (const InputError&) {
}

KnownArtefact known_of(const std::filesystem::path& file, const SegmentRow& row) {
  return {file, row.stage, item_label(row.item), row.key, row.content};
}

void read_record(const Segment& segment, const SegmentRow& row, KnownArtefact& known) try {
  auto artefact = segment.read(row, Segment::Part::record);
  if (!artefact) return;
  known.recipe = std::move(artefact->recipe);
  for (const auto& [name, value] : artefact->note.attributes)
    if (const auto* text = std::get_if<std::string>(&value); text != nullptr && name == kPartsAttribute)
      known.parts = *text;
} catch (const InputError&) {
}

std::vector<KnownArtefact> with_recipes(const std::filesystem::path& file) {
  std::vector<KnownArtefact> found;
  visit_rows(file, [&](const Segment& segment, const SegmentRow& row) {
    found.push_back(known_of(file, row));
    read_record(segment, row, found.back());
  });
  return found;
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

std::vector<RecipeDifference> differences_of_parts(const std::string& before, const std::string& after) {
  std::vector<RecipeDifference> found;
  compare(RecipeDifference::Part::part, lines_of(before), lines_of(after), found);
  std::erase_if(found, [](const auto& each) { return each.part == RecipeDifference::Part::order; });
  return found;
}

std::vector<KnownArtefact> RecipeBook::read_family(const std::string& label) {
  std::vector<KnownArtefact> found;
  for (const auto& file : list_segments(folder_, label))
    std::ranges::move(with_recipes(file), std::back_inserter(found));
  read_ += found.size();
  return found;
}

std::vector<KnownArtefact> RecipeBook::find(std::string_view family, std::string_view stage,
                                            std::string_view item, const Digest& key) {
  const std::string label = item_label(family), of_item = item_label(item);
  const auto is_asked_for = [&](const KnownArtefact& artefact) {
    return artefact.label == of_item && (artefact.stage == stage || artefact.key == key);
  };
  auto known = families_.find(label);
  if (known == families_.end()) known = families_.emplace(label, read_family(label)).first;
  std::vector<KnownArtefact> found;
  std::ranges::copy_if(known->second, std::back_inserter(found), is_asked_for);
  return found;
}

std::unordered_set<Digest> older_versions(const std::filesystem::path& folder, std::string_view stages,
                                          std::string_view but_for) {
  using Time = std::filesystem::file_time_type;
  struct Made {
    Digest key, content;
    std::vector<Digest> inputs;
    std::string versions_of;  // empty: it is no version of anything
  };
  std::vector<Made> all;
  std::map<std::string, Time> newest;
  std::unordered_map<Digest, Time> newest_copy;  // one may be in several files
  for (const auto& file : list_segments(folder)) {
    std::error_code gone;
    const Time written = std::filesystem::last_write_time(file, gone);
    if (gone) continue;
    for (const KnownArtefact& known : with_recipes(file)) {
      if (!known.recipe) continue;
      Made made{known.key, known.content, {}, {}};
      Time& copy = newest_copy.try_emplace(known.key, written).first->second;
      copy = std::max(copy, written);
      std::string rest = fmt::format("{}/{}/{}", known.stage, known.label, known.recipe->seed);
      for (const auto& [name, digest] : known.recipe->inputs) {
        made.inputs.push_back(digest);
        if (name != but_for) rest += fmt::format("/{} {}", name, digest.hex());
      }
      if (known.stage.starts_with(stages)) {
        Time& latest = newest.try_emplace(rest, written).first->second;
        latest = std::max(latest, written);
        made.versions_of = std::move(rest);
      }
      all.push_back(std::move(made));
    }
  }
  std::unordered_set<Digest> keys, contents;
  const auto is_older = [&](const Made& made) {
    return (!made.versions_of.empty() && newest_copy.at(made.key) < newest.at(made.versions_of)) ||
           std::ranges::any_of(made.inputs, [&](const Digest& input) { return contents.contains(input); });
  };
  for (std::size_t before = 1; keys.size() != before;) {
    before = keys.size();
    for (const Made& made : all)
      if (is_older(made)) keys.insert(made.key);
    contents.clear();
    for (const Made& made : all)
      if (keys.contains(made.key)) contents.insert(made.content);
    for (const Made& made : all)  // that a version which stays has, too
      if (!keys.contains(made.key)) contents.erase(made.content);
  }
  return keys;
}

std::vector<KnownArtefact> artefacts_in(const std::filesystem::path& file) {
  std::vector<KnownArtefact> found;
  visit_rows(file, [&](const Segment&, const SegmentRow& row) { found.push_back(known_of(file, row)); });
  return found;
}

std::optional<Artefact> read_artefact(const KnownArtefact& known) {
  const auto segment = Segment::open(known.file);
  if (!segment) return {};
  const auto row = std::ranges::find(segment->rows(), known.key, &SegmentRow::key);
  return row == segment->rows().end() ? std::nullopt : segment->read(*row, Segment::Part::all);
}

std::string fault_of(const KnownArtefact& known) try {
  const std::optional<Artefact> artefact = read_artefact(known);
  const bool differs = artefact && content_digest(arrays_of(*artefact)) != artefact->content;
  return differs ? "its content is not what it was named by" : "";
} catch (const InputError& error) {
  return error.what();
}

}  // namespace salbench
