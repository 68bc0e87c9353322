// SPDX-License-Identifier: GPL-3.0-or-later
// Artefacts of a cache folder, for tests that inspect, remove or damage its files.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cache/layout.h"
#include "cache/recipes.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/progress.h"

namespace salbench {

inline std::vector<KnownArtefact> artefacts_of(const std::filesystem::path& cache) {
  std::vector<KnownArtefact> found;
  for (const auto& file : list_segments(cache))
    std::ranges::move(artefacts_in(file), std::back_inserter(found));
  return found;
}

// "stage@item" of each, sorted.
inline std::vector<std::string> artefact_names(const std::filesystem::path& cache) {
  std::vector<std::string> names;
  for (const KnownArtefact& artefact : artefacts_of(cache))
    names.push_back(artefact.stage + "@" + artefact.label);
  std::ranges::sort(names);
  return names;
}

// Segments with artefacts of a stage, for one item or all.
inline std::vector<std::filesystem::path> files_with(const std::filesystem::path& cache,
                                                     const std::string& stage, const std::string& item = "") {
  std::vector<std::filesystem::path> files;
  for (const KnownArtefact& artefact : artefacts_of(cache))
    if (artefact.stage == stage && (item.empty() || artefact.label == item) &&
        std::ranges::find(files, artefact.file) == files.end())
      files.push_back(artefact.file);
  if (files.empty()) throw std::runtime_error("no artefact of " + stage + " " + item);
  return files;
}

// Removes artefacts as if they had never been stored.
inline void lose(const std::filesystem::path& cache, const std::string& stage, const std::string& item = "") {
  for (const std::filesystem::path& file : files_with(cache, stage, item)) {
    std::vector<ArtefactPtr> kept;
    {
      const std::optional<Segment> segment = Segment::open(file);
      for (const SegmentRow& row : segment->rows())
        if (row.stage != stage || (!item.empty() && item_label(row.item) != item))
          kept.push_back(std::make_shared<const Artefact>(*segment->read(row, Segment::Part::all)));
    }
    std::filesystem::remove(file);
    if (!kept.empty())
      write_segment(cache, parse_segment_name(file.filename().native())->label, segment_image(kept));
  }
}

inline void flip_byte(const std::filesystem::path& file, std::uint64_t at) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekg(static_cast<std::streamoff>(at));
  const auto byte = static_cast<char>(stream.get());
  stream.seekp(static_cast<std::streamoff>(at));
  stream.put(static_cast<char>(byte ^ 0x10));
}

// Flips a byte of an artefact within its segment.
inline void damage(const std::filesystem::path& cache, const std::string& stage,
                   const std::string& item = "") {
  for (const std::filesystem::path& file : files_with(cache, stage, item)) {
    const std::optional<Segment> segment = Segment::open(file);
    for (const SegmentRow& row : segment->rows())
      if (row.stage == stage && (item.empty() || item_label(row.item) == item)) flip_byte(file, row.at + 3);
  }
}

// Counts of the last loop that began.
struct CountedProgress final : Progress {
  void begin(const std::string&, std::size_t items, std::function<std::string()>) override {
    expected = items;
    done = 0;
  }
  void item_done() override { ++done; }
  void end() override {}
  std::size_t expected = 0;
  std::atomic<std::size_t> done = 0;
};

// Damage as by a disk: a later check marks the segment as undamaged, so that the reader of the artefact finds
// it first.
inline void damage_unseen(const std::filesystem::path& cache, const std::string& stage,
                          const std::string& item = "") {
  damage(cache, stage, item);
  std::int64_t last_change = 0;
  for (const std::filesystem::path& file : list_segments(cache))
    last_change = std::max(last_change, OpenFile::open(file)->changed_ns());
  do note_check(cache);
  while (last_check(cache) <= last_change);  // until the file system's clock has ticked
}

}  // namespace salbench
