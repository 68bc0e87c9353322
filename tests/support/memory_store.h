// SPDX-License-Identifier: GPL-3.0-or-later
// An in-memory cache for tests that count jobs.
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
    std::string stage, item;
    Digest content;
    Arrays arrays;
    std::string remark;
    bool damaged = false;

    bool is(std::string_view of_stage, std::string_view of_item) const {
      return stage == of_stage && item == of_item;
    }
  };

  std::optional<Digest> find(const Digest& key) const override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    return found == entries_.end() ? std::nullopt : std::optional(found->second.content);
  }
  bool has_item(std::string_view stage, std::string_view item) const override {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(entries_, [&](const auto& e) { return e.second.is(stage, item); });
  }
  std::vector<std::string> stages() const override {
    const std::lock_guard lock(mutex_);
    std::set<std::string> names;
    for (const auto& [key, entry] : entries_) names.insert(entry.stage);
    return {names.begin(), names.end()};
  }
  std::optional<Arrays> load(const Digest& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return {};
    if (found->second.damaged) {
      entries_.erase(found);
      return {};
    }
    return found->second.arrays;
  }

  std::string remark(const Digest& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    return found == entries_.end() ? std::string() : found->second.remark;
  }

  void save(std::string_view, Artefact artefact) override {
    const std::lock_guard lock(mutex_);
    entries_[artefact.key] = {artefact.recipe.stage, artefact.note.item, artefact.content,
                              arrays_of(artefact), artefact.note.remark};
    saved_.push_back(artefact.recipe.stage + "@" + artefact.note.item);
  }

  // "stage@item" of everything saved since the last call, sorted.
  std::vector<std::string> take_saved() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> result = std::move(saved_);
    saved_.clear();
    std::ranges::sort(result);
    return result;
  }
  void clear() { entries_.clear(); }
  void remove(const std::string& stage, const std::string& item) {
    std::erase_if(entries_, [&](const auto& e) { return e.second.is(stage, item); });
  }
  void damage(const std::string& stage, const std::string& item) {
    for (auto& [key, entry] : entries_)
      if (entry.is(stage, item)) entry.damaged = true;
  }
  std::string stage_of(const Digest& key) const {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    return found == entries_.end() ? std::string() : found->second.stage;
  }

 private:
  mutable std::mutex mutex_;
  std::map<Digest, Entry> entries_;
  std::vector<std::string> saved_;
};

}  // namespace salbench
