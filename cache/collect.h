// SPDX-License-Identifier: GPL-3.0-or-later
// Garbage collection: removes the artefacts that a named scope does not need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "cache/artefact_name.h"
#include "stages/core/progress.h"

namespace salbench {

// Artefacts to keep. A key that is not known yet is covered by keeping everything of its stage and item.
class KeepSet {
 public:
  void add(std::string_view stage, const Digest& key);
  void add_every_key(std::string_view stage, std::string_view item);
  bool covers(std::string_view stage, const ArtefactName& name) const;

 private:
  struct OfStage {
    std::unordered_set<Digest> keys;
    std::set<std::string, std::less<>> items;  // labels
  };
  std::map<std::string, OfStage, std::less<>> stages_;
};

struct Amount {
  std::size_t files = 0;
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

// Removes what `needed` does not cover, quarantined artefacts, and dead temporary files; `dry_run` only
// counts them. Files that are not artefacts are never touched. Throws StorageError if the folder is not a
// cache, or if a file cannot be removed.
Collected collect_garbage(const std::filesystem::path& folder, const KeepSet& needed, bool dry_run,
                          Progress& progress);

}  // namespace salbench
