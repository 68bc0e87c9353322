// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/entry_table.h"

#include <algorithm>
#include <mutex>

#include "cache/artefact.h"

namespace salbench {

void EntryTable::insert(std::span<const Row> rows) {
  const std::unique_lock lock(mutex_);
  const Row* before = nullptr;  // most have its item
  std::uint32_t label = 0;
  for (const Row& row : rows) {
    entries_.emplace(row.key, row.entry);
    auto stage = stages_.find(row.stage);
    if (stage == stages_.end()) stage = stages_.emplace(row.stage, Stage()).first;
    ++stage->second.artefacts;
    stage->second.bytes += row.entry.bytes;
    if (before == nullptr || before->item != row.item) {
      const auto next = static_cast<std::uint32_t>(labels_.size());
      label = labels_.try_emplace(item_label(row.item), next).first->second;
    }
    std::vector<bool>& has_item = stage->second.has_item;
    if (has_item.size() <= label) has_item.resize(label + 1);
    has_item[label] = true;
    before = &row;
  }
}

void EntryTable::erase(const Digest& key, const Entry& entry) {
  const std::unique_lock lock(mutex_);
  const auto [first, last] = entries_.equal_range(key);
  const auto found = std::find_if(first, last, [&](const auto& known) {
    return known.second.file == entry.file && known.second.row == entry.row;
  });
  if (found != last) entries_.erase(found);
}

std::vector<EntryTable::Entry> EntryTable::find(const Digest& key) const {
  std::vector<Entry> found;
  {
    const std::shared_lock lock(mutex_);
    const auto [first, last] = entries_.equal_range(key);
    for (auto entry = first; entry != last; ++entry) found.push_back(entry->second);
  }
  std::ranges::sort(found, {}, &Entry::content);
  return found;
}

bool EntryTable::has_item(std::string_view stage_name, std::string_view item) const {
  const std::shared_lock lock(mutex_);
  const auto stage = stages_.find(stage_name);
  const auto label = labels_.find(item_label(item));
  if (stage == stages_.end() || label == labels_.end()) return false;
  const std::vector<bool>& has_item = stage->second.has_item;
  return label->second < has_item.size() && has_item[label->second];
}

std::vector<EntryTable::Usage> EntryTable::usage() const {
  const std::shared_lock lock(mutex_);
  std::vector<Usage> result;
  for (const auto& [name, stage] : stages_) result.push_back({name, stage.artefacts, stage.bytes});
  return result;
}

}  // namespace salbench
