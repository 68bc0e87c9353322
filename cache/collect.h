// SPDX-License-Identifier: GPL-3.0-or-later
// Garbage collection: removes the artefacts that a named scope does not need.
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

// Artefacts to keep. A key that is not known yet is covered by keeping everything of its stage and item.
class KeepSet {
 public:
  void add(const Digest& key) { keys_.insert(key); }
  void add_every_key(std::string_view stage, std::string_view item);

  // And then keep all others.
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
  Amount damaged;               // segments in which damage is found, now or before
  Amount unfinished;            // left behind in tmp/ by killed processes
};

// Removes what `needed` does not cover, damaged segments, and dead temporary files; `dry_run` only counts
// them. Reads every segment to its end. Those that hold more than is needed are written anew, before they are
// removed, as are those of a family that has many. Other files are never touched. Throws StorageError if the
// folder is not a cache, or if a file cannot be written or removed.
Collected collect_garbage(const std::filesystem::path& folder, const KeepSet& needed, bool dry_run,
                          Progress& progress);

}  // namespace salbench
