// SPDX-License-Identifier: GPL-3.0-or-later
// In-memory index of a cache, read from the heads of its files: key -> content, file and row.
#pragma once

#include <cstdint>
#include <map>
#include <shared_mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/digest.h"

namespace salbench {

// Thread-safe.
class EntryTable {
 public:
  // Compact: a million shapes have twenty million of these.
  struct Entry {
    Digest content;
    std::uint64_t bytes = 0;
    std::uint32_t file = 0, row = 0;
  };

  struct Row {
    std::string_view stage, item;
    Digest key;
    Entry entry;
  };
  void insert(std::span<const Row> rows);  // in batches, since other threads wait
  void erase(const Digest& key, const Entry& entry);

  // Several if processes repeated work, or one artefact was damaged. Smallest content first: should a stage
  // be non-deterministic, all machines take the same result.
  std::vector<Entry> find(const Digest& key) const;
  bool has_item(std::string_view stage, std::string_view item) const;  // also after an `erase`

  struct Usage {
    std::string stage;
    std::size_t artefacts = 0;
    std::uint64_t bytes = 0;
  };
  std::vector<std::string> stages() const;  // by name
  std::vector<Usage> usage() const;         // by stage name

 private:
  struct Stage {
    std::size_t artefacts = 0;
    std::uint64_t bytes = 0;
    std::vector<bool> has_item;  // [label]
  };

  struct Record {
    Digest key;
    Entry entry;
  };
  void reserve(std::size_t records);
  template <class Visit>
  std::size_t probe(const Digest& key, const Visit& visit) const;

  mutable std::shared_mutex mutex_;
  // Open addressing: keys are uniformly distributed, and a rerun consists mostly of look-ups.
  std::vector<Record> records_;
  std::vector<std::uint32_t> slots_ = {0};  // 1-based record numbers; 0: free
  std::map<std::string, Stage, std::less<>> stages_;
  std::unordered_map<std::string, std::uint32_t> labels_;  // numbered, since an item has dozens of artefacts
};

}  // namespace salbench
