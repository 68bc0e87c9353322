// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/entry_table.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <mutex>

#include "cache/artefact.h"

namespace salbench {
namespace {

constexpr std::uint32_t kErased = std::numeric_limits<std::uint32_t>::max();  // stored as the file number

}  // namespace

// Visits every record of the key, and returns the next free slot.
template <class Visit>
std::size_t EntryTable::probe(const Digest& key, const Visit& visit) const {
  std::size_t slot = key.low & (slots_.size() - 1);
  for (; slots_[slot] != 0; slot = (slot + 1) & (slots_.size() - 1))
    if (const std::size_t record = slots_[slot] - 1; records_[record].key == key) visit(record);
  return slot;
}

// Keeps at least half of the slots free.
void EntryTable::reserve(std::size_t records) {
  if (2 * records <= slots_.size()) return;
  slots_.assign(std::bit_ceil(2 * records), 0);
  for (std::size_t i = 0; i < records_.size(); ++i)
    slots_[probe(records_[i].key, [](std::size_t) {})] = static_cast<std::uint32_t>(i + 1);
}

void EntryTable::insert(std::span<const Row> rows) {
  const std::unique_lock lock(mutex_);
  reserve(records_.size() + rows.size());
  const Row* before = nullptr;  // adjacent rows mostly share their item
  std::uint32_t label = 0;
  for (const Row& row : rows) {
    records_.push_back({row.key, row.entry});
    slots_[probe(row.key, [](std::size_t) {})] = static_cast<std::uint32_t>(records_.size());
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
  probe(key, [&](std::size_t record) {
    Entry& known = records_[record].entry;
    if (known.file == entry.file && known.row == entry.row) known.file = kErased;
  });
}

std::vector<EntryTable::Entry> EntryTable::find(const Digest& key) const {
  std::vector<Entry> found;
  {
    const std::shared_lock lock(mutex_);
    probe(key, [&](std::size_t record) {
      if (records_[record].entry.file != kErased) found.push_back(records_[record].entry);
    });
  }
  if (found.size() > 1) std::ranges::sort(found, {}, &Entry::content);
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

std::vector<std::string> EntryTable::stages() const {
  const std::shared_lock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, stage] : stages_) names.push_back(name);
  return names;
}

std::vector<EntryTable::Usage> EntryTable::usage() const {
  const std::shared_lock lock(mutex_);
  std::vector<Usage> result;
  for (const auto& [name, stage] : stages_) result.push_back({name, stage.artefacts, stage.bytes});
  return result;
}

}  // namespace salbench
