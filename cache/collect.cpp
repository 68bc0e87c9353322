// SPDX-License-Identifier: GPL-3.0-or-later
// Empty folders stay: another process may be about to rename a segment into one. A run that still knows a
// segment which is gone looks for what was in it among the family's others.
#include "cache/collect.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "cache/format1.h"
#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kManySegments = 8;             // of a family
constexpr std::uintmax_t kMostReplaced = 1U << 30U;  // bytes on the disk twice

// A file that disappeared in the meantime is ignored.
void remove_file(const fs::path& file, bool dry_run, Amount& amount) {
  const auto size = size_of_file(file);
  if (!size) return;
  if (!dry_run) salbench::remove_file(file);
  amount.add(*size);
}

bool is_quarantined(const fs::path& file) {
  const std::string name = file.filename();
  return parse_segment_name(name) || parse_damaged_name(name) || old_artefact_at(file);
}

class Collector {
 public:
  Collector(const fs::path& folder, const KeepSet& needed, bool dry_run)
      : folder_(folder), needed_(needed), dry_run_(dry_run), damaged_(list_damaged(folder)) {}

  // The files of one family. Returns whether it has to be written anew: when all that can go has gone, since
  // a disk may be full.
  bool collect(const std::vector<fs::path>& files) {
    const std::size_t removed_before = removed_;
    std::set<Digest> keys;
    bool any_other = false;  // damaged, of salbench 1.0, or of a key that another has
    std::size_t segments = 0;
    for (const fs::path& file : files)
      if (const auto segment = opened(file)) {
        ++segments;
        any_other |= segment->is_old();
        for (const SegmentRow& row : segment->rows())
          if (count(row)) any_other |= is_damaged(file, row) || !keys.insert(row.key).second;
      }
    if (removed_ == removed_before && !any_other && segments < kManySegments) return false;
    if (!keys.empty()) return true;
    if (!dry_run_) {
      rewrite({}, files);
      remove_replaced();
    }
    return false;
  }

  // Writes what is needed of a family's files into one. The others stay until remove_replaced.
  void rewrite(const std::string& label, const std::vector<fs::path>& files) {
    Segments segments;
    for (const fs::path& file : files)
      if (auto segment = opened(file)) segments.emplace_back(file, std::move(*segment));
    Artefacts kept =
        read(segments, [&](const SegmentRow& row) { return needed_.covers(row.stage, row.item, row.key); });
    const Artefacts remarks = read(segments, [](const SegmentRow& row) { return row.stage == kOldRemarks; });
    for (auto& [key, artefact] : kept)
      if (const auto found = remarks.find(old_remark_key(artefact.recipe.stage, key)); found != remarks.end())
        artefact.note.remark = old_remark(found->second);
    const bool any_old = std::ranges::any_of(segments, [](const auto& each) { return each.second.is_old(); });
    if (any_old) prepare_cache(folder_);  // which says its format
    any_written_ |= !kept.empty();
    const fs::path written = write(label, std::move(kept));
    for (const auto& [path, segment] : segments) {
      if (path == written) continue;
      replaced_.emplace_back(path, segment.is_old());
      replaced_bytes_ += size_of_file(path).value_or(0);
    }
    if (replaced_bytes_ > kMostReplaced) remove_replaced();
  }

  // After what was written in their place is on the disk, so that a power cut loses neither.
  void remove_replaced() {
    if (std::exchange(any_written_, false)) sync_file_system(folder_);
    for (const auto& [path, is_old] : replaced_) {
      salbench::remove_file(path);
      if (is_old) remove_empty(path.parent_path());
    }
    replaced_.clear();
    replaced_bytes_ = 0;
  }

  std::vector<Collected::OfStage> stages() const {
    std::vector<Collected::OfStage> all;
    for (const auto& [name, stage] : stages_) all.push_back(stage);
    return all;
  }

 private:
  using Segments = std::vector<std::pair<fs::path, Segment>>;
  using Artefacts = std::map<Digest, Artefact>;  // by key

  // Nothing of one that is gone, or whose head is damaged: a run moves it aside.
  static std::optional<Segment> opened(const fs::path& file) try {
    return Segment::open(file);
  } catch (const InputError&) {
    return {};
  }

  bool is_damaged(const fs::path& file, const SegmentRow& row) const {
    return damaged_.contains({file.filename().string(), row.key});
  }

  bool count(const SegmentRow& row) {
    Collected::OfStage& of_stage =
        stages_.try_emplace(row.stage, Collected::OfStage{row.stage, {}, {}}).first->second;
    const bool is_needed = needed_.covers(row.stage, row.item, row.key);
    (is_needed ? of_stage.kept : of_stage.removed).add(row.bytes);
    removed_ += is_needed ? 0U : 1U;
    return is_needed;
  }

  // Those of some rows, as far as they are sound. Of several with one key that which runs take:
  // EntryTable::find.
  template <class IsWanted>
  Artefacts read(const Segments& segments, const IsWanted& is_wanted) const {
    Artefacts found;
    for (const auto& [path, segment] : segments)
      for (const SegmentRow& row : segment.rows()) try {
          if (!is_wanted(row) || is_damaged(path, row)) continue;
          const auto known = found.find(row.key);
          if (known != found.end() && known->second.content <= row.content) continue;
          if (auto artefact = segment.read(row, Segment::Part::all))
            found.insert_or_assign(row.key, std::move(*artefact));
        } catch (const InputError& error) {
          spdlog::warn("{}: {}; removed", path.string(), error.what());
        }
    return found;
  }

  // A folder of salbench 1.0 goes with its last file.
  static void remove_empty(const fs::path& shard) {
    std::error_code in_use;
    fs::remove(shard, in_use);
    fs::remove(shard.parent_path(), in_use);
  }

  fs::path write(const std::string& label, Artefacts&& kept) const {
    if (kept.empty()) return {};
    std::vector<ArtefactPtr> artefacts;
    for (auto& [key, artefact] : kept)
      artefacts.push_back(std::make_shared<const Artefact>(std::move(artefact)));
    return write_segment(folder_, label, segment_image(artefacts));
  }

  const fs::path& folder_;
  const KeepSet& needed_;
  bool dry_run_;
  const std::set<DamagedName> damaged_;
  std::size_t removed_ = 0;
  std::map<std::string, Collected::OfStage> stages_;
  std::vector<std::pair<fs::path, bool>> replaced_;  // files, and whether they are of salbench 1.0
  std::uintmax_t replaced_bytes_ = 0;
  bool any_written_ = false;  // since the last sync
};

}  // namespace

void KeepSet::add_every_key(std::string_view stage, std::string_view item) {
  items_.emplace(stage, item_label(item));
}

void KeepSet::add_family(std::string_view family, std::string_view item) {
  families_[item_label(item)] = item_label(family);
}

bool KeepSet::covers(std::string_view stage, std::string_view item, const Digest& key) const {
  if (dropped_keys_) return !dropped_keys_->contains(key);
  if (!dropped_.empty()) return !dropped_.contains(stage);
  return keys_.contains(key) || items_.contains({std::string(stage), item_label(item)});
}

std::string KeepSet::family_of(const std::string& label) const {
  const auto found = families_.find(label);
  return found == families_.end() ? label : found->second;
}

Collected collect_garbage(const fs::path& folder, const KeepSet& needed, bool dry_run, Progress& progress) {
  require_cache(folder);
  Collected result;
  std::map<std::string, std::vector<fs::path>> families;
  for (const fs::path& file : list_files(folder)) {
    const auto name = parse_segment_name(file.filename().native());
    families[name ? name->label : needed.family_of(old_artefact_at(file)->label)].push_back(file);
  }
  Collector collector(folder, needed, dry_run);
  std::size_t all = 0;
  for (const auto& [label, files] : families) all += files.size();
  progress.begin("collecting", all);
  std::vector<std::string> anew;
  for (const auto& [label, files] : families) {
    if (collector.collect(files)) anew.push_back(label);
    for (std::size_t left = files.size(); left > 0; --left) progress.item_done();
  }
  for (const std::string& label : anew)
    if (!dry_run) collector.rewrite(label, families[label]);
  collector.remove_replaced();
  progress.end();
  result.stages = collector.stages();
  for (const FolderEntry& entry : list_folder(folder / kDamagedFolder))
    if (!entry.is_folder && is_quarantined(entry.path)) remove_file(entry.path, dry_run, result.damaged);
  visit_abandoned(folder / kScratchFolder,
                  [&](const fs::path& file) { remove_file(file, dry_run, result.unfinished); });
  return result;
}

}  // namespace salbench
