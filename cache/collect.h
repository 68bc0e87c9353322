// SPDX-License-Identifier: GPL-3.0-or-later
// Garbage collection: removes the artefacts that a named scope does not need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
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
  void add_family(std::string_view family, std::string_view item);  // that an item belongs to

  // And then keep all others.
  void drop(std::string_view stage) { dropped_.emplace(stage); }
  void drop(const std::unordered_set<Digest>& keys) { dropped_keys_ = keys; }

  bool covers(std::string_view stage, std::string_view item, const Digest& key) const;
  std::string family_of(const std::string& label) const;  // of an item; labels

 private:
  std::unordered_set<Digest> keys_;
  std::set<std::pair<std::string, std::string>> items_;  // stage, label
  std::map<std::string, std::string> families_;          // by the item's label
  std::set<std::string, std::less<>> dropped_;
  std::optional<std::unordered_set<Digest>> dropped_keys_;
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
  Amount damaged;               // removed from damaged/
  Amount unfinished;            // left behind in tmp/ by killed processes
};

// Removes what `needed` does not cover, quarantined segments, and dead temporary files; `dry_run` only counts
// them. Segments that hold more than is needed are written anew, before they are removed, as are those of a
// family that has many, and artefacts of format 1. Other files are never touched. Throws StorageError if the
// folder is not a cache, or if a file cannot be written or removed.
Collected collect_garbage(const std::filesystem::path& folder, const KeepSet& needed, bool dry_run,
                          Progress& progress);

}  // namespace salbench
