// SPDX-License-Identifier: GPL-3.0-or-later
// Garbage collection: removes artefacts that are not in a set to keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "io/digest.h"
#include "stages/core/progress.h"

namespace salbench {

// Artefacts to keep. Unknown keys are covered by keeping everything of their stage and item.
class KeepSet {
 public:
  void add(const Digest& key) { keys_.insert(key); }
  void add_every_key(std::string_view stage, std::string_view item);

  // Drops a stage; all others are then kept.
  void drop(std::string_view stage) { dropped_.emplace(stage); }

  bool covers(std::string_view stage, std::string_view item, const Digest& key) const;

 private:
  std::unordered_set<Digest> keys_;
  std::set<std::pair<std::string, std::string>> items_;  // stage, label
  std::set<std::string, std::less<>> dropped_;
};

struct Amount {
  std::size_t files = 0;  // or artefacts
  std::uint64_t bytes = 0;

  void add(std::uint64_t size) {
    ++files;
    bytes += size;
  }
};

struct Collected {
  struct OfStage {
    std::string stage;
    Amount kept, removed;
  };
  std::vector<OfStage> stages;  // by name
  Amount damaged;               // damaged segments, old and newly found
  Amount unfinished;            // files left in tmp/ by killed processes
};

// Removes everything that `needed` does not cover, damaged segments, and dead temporary files; `dry_run` only
// counts them. Reads every segment to its end. Segments with unneeded artefacts are rewritten before they are
// removed, and those of a family with many segments are merged. Other files are never touched. Throws
// StorageError if the folder is not a cache, or if a file cannot be written or removed.
Collected collect_garbage(const std::filesystem::path& folder, const KeepSet& needed, bool dry_run,
                          Progress& progress);

}  // namespace salbench
