// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/name_index.h"

#include <algorithm>
#include <mutex>

namespace salbench {
namespace {

template <class Entries>
auto place(Entries& entries, const Digest& key) {
  return std::ranges::lower_bound(entries, key, {}, [](const auto& entry) { return entry.key; });
}

}  // namespace

void NameIndex::insert(std::string_view stage_name, std::span<const ArtefactName> names) {
  static_assert(sizeof(Entry) == 56);
  if (names.empty()) return;
  const std::unique_lock lock(mutex_);
  Stage& stage = stages_[std::string(stage_name)];
  for (const ArtefactName& name : names) {
    const auto [label, fresh] = labels_.try_emplace(name.item, static_cast<std::uint32_t>(label_of_.size()));
    if (fresh) label_of_.push_back(&label->first);
    if (stage.has_item.size() <= label->second) stage.has_item.resize(label_of_.size());
    stage.has_item[label->second] = true;
    std::vector<Entry>& entries = stage.entries[shard_number(name.key)];
    // Not twice the room, as a vector would take.
    if (entries.size() == entries.capacity())
      entries.reserve(entries.size() + std::max(names.size(), entries.size() / 8));
    const Entry entry{name.key, name.content, name.checksum, name.size, label->second};
    const auto at = place(entries, name.key);
    if (at == entries.end() || at->key != name.key)
      entries.insert(at, entry);
    else if (name.content < at->content)
      *at = entry;
  }
}

void NameIndex::erase(std::string_view stage, const Digest& key) {
  const std::unique_lock lock(mutex_);
  if (const auto found = stages_.find(stage); found != stages_.end())
    std::erase_if(found->second.entries[shard_number(key)],
                  [&](const Entry& entry) { return entry.key == key; });
}

std::optional<ArtefactName> NameIndex::find(std::string_view stage, const Digest& key) const {
  const std::shared_lock lock(mutex_);
  const auto found = stages_.find(stage);
  if (found == stages_.end()) return {};
  const std::vector<Entry>& entries = found->second.entries[shard_number(key)];
  const auto at = place(entries, key);
  if (at == entries.end() || at->key != key) return {};
  return ArtefactName{*label_of_[at->label], at->key, at->content, at->checksum, at->size};
}

bool NameIndex::has_item(std::string_view stage, std::string_view item) const {
  const std::shared_lock lock(mutex_);
  const auto found = stages_.find(stage);
  const auto label = labels_.find(item_label(item));
  if (found == stages_.end() || label == labels_.end()) return false;
  return label->second < found->second.has_item.size() && found->second.has_item[label->second];
}

std::vector<NameIndex::Usage> NameIndex::usage() const {
  const std::shared_lock lock(mutex_);
  std::vector<Usage> result;
  for (const auto& [name, stage] : stages_) {
    Usage usage{name, 0, 0};
    for (const std::vector<Entry>& entries : stage.entries)
      for (const Entry& entry : entries) {
        ++usage.artefacts;
        usage.bytes += entry.size;
      }
    result.push_back(std::move(usage));
  }
  return result;
}

}  // namespace salbench
