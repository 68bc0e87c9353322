// SPDX-License-Identifier: GPL-3.0-or-later
// The names of a folder's artefacts in 56 bytes each: a shape has some twenty of them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <shared_mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cache/artefact_name.h"
#include "cache/layout.h"

namespace salbench {

// Safe to call from several threads.
class NameIndex {
 public:
  // Keeps the smaller of two contents under one key: some stage is not deterministic, and every machine
  // should take the same. Quick if the names are sorted by key.
  void insert(std::string_view stage, std::span<const ArtefactName> names);
  void erase(std::string_view stage, const Digest& key);

  std::optional<ArtefactName> find(std::string_view stage, const Digest& key) const;
  bool has_item(std::string_view stage, std::string_view item) const;  // or had, before an `erase`

  struct Usage {
    std::string stage;
    std::size_t artefacts = 0;
    std::uint64_t bytes = 0;
  };
  std::vector<Usage> usage() const;  // by stage name

 private:
  struct Entry {
    Digest key, content;
    std::uint64_t checksum, size;
    std::uint32_t label;  // its number
  };
  struct Stage {
    std::array<std::vector<Entry>, kShards> entries;  // [shard_number], by key
    std::vector<bool> has_item;                       // [label]
  };

  mutable std::shared_mutex mutex_;
  std::map<std::string, Stage, std::less<>> stages_;
  std::unordered_map<std::string, std::uint32_t> labels_;  // numbers; an item has dozens of artefacts
  std::vector<const std::string*> label_of_;               // [number]
};

}  // namespace salbench
