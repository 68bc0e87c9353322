// SPDX-License-Identifier: GPL-3.0-or-later
// The cache without a disk: for tests that count jobs.
#pragma once

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "cache/store.h"

namespace salbench {

class MemoryStore : public Store {
 public:
  struct Entry {
    std::string item;
    Digest content;
    Arrays arrays;
    std::string remark;
    bool damaged = false;
  };

  std::optional<Digest> find(std::string_view stage, const Digest& key) const override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find({std::string(stage), key});
    return found == entries_.end() ? std::nullopt : std::optional(found->second.content);
  }
  bool has_item(std::string_view stage, std::string_view item) const override {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, entry] : entries_)
      if (id.first == stage && entry.item == item) return true;
    return false;
  }
  std::optional<Arrays> load(std::string_view stage, const Digest& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find({std::string(stage), key});
    if (found == entries_.end()) return {};
    if (found->second.damaged) {
      entries_.erase(found);
      return {};
    }
    return found->second.arrays;
  }

  std::string remark(std::string_view stage, const Digest& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find({std::string(stage), key});
    return found == entries_.end() ? std::string() : found->second.remark;
  }

  void save(std::string_view, Artefact artefact) override {
    const std::lock_guard lock(mutex_);
    entries_[{artefact.recipe.stage, artefact.key}] = {artefact.note.item, artefact.content,
                                                       arrays_of(artefact), artefact.note.remark};
    saved_.push_back(artefact.recipe.stage + "@" + artefact.note.item);
  }

  // "stage@item" of everything saved since the last call, sorted.
  std::vector<std::string> take_saved() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> result = std::move(saved_);
    saved_.clear();
    std::sort(result.begin(), result.end());
    return result;
  }
  void clear() { entries_.clear(); }
  void remove(const std::string& stage, const std::string& item) {
    std::erase_if(entries_, [&](const auto& e) { return e.first.first == stage && e.second.item == item; });
  }
  void damage(const std::string& stage, const std::string& item) {
    for (auto& [id, entry] : entries_)
      if (id.first == stage && entry.item == item) entry.damaged = true;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, Digest>, Entry> entries_;
  std::vector<std::string> saved_;
};

}  // namespace salbench
