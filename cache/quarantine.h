// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps later runs from reading damaged parts of a cache. A damaged segment is moved to damaged/; a damaged
// artefact is listed there by name, and its segment stays. May be called from several threads.
#pragma once

#include <filesystem>
#include <set>
#include <shared_mutex>
#include <string>
#include <string_view>

#include "cache/layout.h"

namespace salbench {

class Quarantine {
 public:
  Quarantine(std::filesystem::path folder, bool may_write)
      : folder_(std::move(folder)), may_write_(may_write) {}

  void list();  // reads which artefacts earlier runs have set aside
  bool has(const std::string& segment, const Digest& key) const;

  // Moves a file aside, and warns with the reason; not of one that has gone meanwhile.
  void move(const std::filesystem::path& file, std::string_view why) const;
  void set_aside(const std::filesystem::path& segment, const Digest& key);
  // Forgets the damaged artefacts of a segment that is about to be written again: equal bytes have equal
  // names.
  void forget(const std::string& segment);

 private:
  std::filesystem::path folder_;
  bool may_write_;
  mutable std::shared_mutex mutex_;
  std::set<DamagedName> artefacts_;
};

}  // namespace salbench
