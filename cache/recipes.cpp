// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/recipes.h"

#include <algorithm>
#include <utility>

#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// Calls `visit` with segment and row. Skips files with a damaged head, whose rows are unknown.
template <class Visit>
void visit_rows(const std::filesystem::path& file, const Visit& visit) try {
  if (const std::optional<Segment> segment = Segment::open(file))
    for (const SegmentRow& row : segment->rows()) visit(*segment, row);
} catch (const InputError&) {
}

KnownArtefact known_of(const std::filesystem::path& file, const SegmentRow& row) {
  return {file, row.stage, item_label(row.item), row.key, row.content};
}

}  // namespace

std::vector<KnownArtefact> known_recipes(const std::filesystem::path& folder, std::string_view family,
                                         std::string_view stage, std::string_view item) {
  std::vector<KnownArtefact> found;
  for (const auto& file : list_segments(folder, item_label(family)))
    visit_rows(file, [&](const Segment& segment, const SegmentRow& row) {
      if (row.stage != stage || item_label(row.item) != item_label(item)) return;
      try {
        if (auto artefact = segment.read(row, Segment::Part::record)) {
          found.push_back(known_of(file, row));
          found.back().recipe = std::move(artefact->recipe);
        }
      } catch (const InputError&) {
      }
    });
  return found;
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

}  // namespace salbench
