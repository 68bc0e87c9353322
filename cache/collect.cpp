// SPDX-License-Identifier: GPL-3.0-or-later
// Empty folders stay: another process may be about to rename a segment into one. A run that still knows a
// segment which is gone computes what was in it again.
#include "cache/collect.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cache/format1.h"
#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kManySegments = 8;  // of a family

// A file that disappeared in the meantime is ignored.
void remove_file(const fs::path& file, bool dry_run, Amount& amount) {
  const auto size = size_of_file(file);
  if (!size) return;
  if (!dry_run) salbench::remove_file(file);
  amount.add(*size);
}

bool is_quarantined(const fs::path& file) {
  const std::string name = file.filename();
  return parse_segment_name(name) || parse_damaged_name(name) || old_artefact_at(file, {});
}

// Files of one family.
struct Files {
  std::vector<SegmentFile> segments;
  std::vector<OldArtefact> old;

  std::size_t size() const { return segments.size() + old.size(); }
};

class Collector {
 public:
  Collector(const fs::path& folder, const KeepSet& needed, bool dry_run)
      : folder_(folder), needed_(needed), dry_run_(dry_run), damaged_(list_damaged(folder)) {}

  void collect(const std::string& label, const Files& files) {
    const std::size_t removed_before = removed_;
    std::set<Digest> keys;
    bool any_damaged = false;  // or replaced by another of its key
    std::vector<std::pair<fs::path, Segment>> segments;
    for (const SegmentFile& file : files.segments)
      if (auto segment = opened(file)) {
        for (const SegmentRow& row : segment->rows())
          if (count(row.stage, row.item, row.key, row.bytes))
            any_damaged |= is_damaged(file.path, row) || !keys.insert(row.key).second;
        segments.emplace_back(file.path, std::move(*segment));
      }
    for (const OldArtefact& old : files.old) count(old.stage, old.label, old.key, old.size);
    const bool as_it_is =
        removed_ == removed_before && !any_damaged && files.old.empty() && segments.size() < kManySegments;
    if (!as_it_is && !dry_run_) rewrite(label, segments, files.old);
  }

  std::vector<Collected::OfStage> stages() const {
    std::vector<Collected::OfStage> all;
    for (const auto& [name, stage] : stages_) all.push_back(stage);
    return all;
  }

 private:
  // Nothing of one that is gone, or whose head is damaged: a run moves it aside.
  static std::optional<Segment> opened(const SegmentFile& file) try {
    return Segment::open(file.path);
  } catch (const InputError&) {
    return {};
  }

  bool is_damaged(const fs::path& file, const SegmentRow& row) const {
    return damaged_.contains({file.filename().string(), row.key});
  }

  bool count(const std::string& stage, std::string_view item, const Digest& key, std::uint64_t bytes) {
    Collected::OfStage& of_stage =
        stages_.try_emplace(stage, Collected::OfStage{stage, {}, {}}).first->second;
    const bool is_needed = needed_.covers(stage, item, key);
    (is_needed ? of_stage.kept : of_stage.removed).add(bytes);
    removed_ += is_needed ? 0U : 1U;
    return is_needed;
  }

  void rewrite(const std::string& label, const std::vector<std::pair<fs::path, Segment>>& segments,
               const std::vector<OldArtefact>& old_artefacts) {
    std::map<Digest, ArtefactPtr> kept;
    const auto keep = [&](const fs::path& file, const auto& read) {
      try {
        if (std::optional<Artefact> artefact = read())
          kept.emplace(artefact->key, std::make_shared<const Artefact>(std::move(*artefact)));
      } catch (const InputError& error) {
        spdlog::warn("{}: {}; removed", file.string(), error.what());
      }
    };
    for (const auto& [path, segment] : segments)
      for (const SegmentRow& row : segment.rows())
        if (needed_.covers(row.stage, row.item, row.key) && !kept.contains(row.key) && !is_damaged(path, row))
          keep(path,
               [&, &segment = segment] { return std::optional(segment.read(row, Segment::Part::all)); });
    for (const OldArtefact& old : old_artefacts)
      if (needed_.covers(old.stage, old.label, old.key) && !kept.contains(old.key))
        keep(old.path, [&] { return with_remark(old, old_artefacts); });
    if (!old_artefacts.empty()) prepare_cache(folder_);  // which says its format
    const fs::path written = write(label, kept);
    for (const auto& [path, segment] : segments)
      if (path != written) salbench::remove_file(path);
    for (const OldArtefact& old : old_artefacts) {
      salbench::remove_file(old.path);
      std::error_code in_use;  // a folder goes with its last file
      for (const fs::path& below : {old.path.parent_path(), old.path.parent_path().parent_path()})
        fs::remove(below, in_use);
    }
  }

  static std::optional<Artefact> with_remark(const OldArtefact& old, const std::vector<OldArtefact>& all) {
    auto artefact = read_old_artefact(old);
    const auto remark = std::ranges::find(all, old_remark_key(old.stage, old.key), &OldArtefact::key);
    if (artefact && remark != all.end()) artefact->note.remark = old_remark(*remark);
    return artefact;
  }

  fs::path write(const std::string& label, const std::map<Digest, ArtefactPtr>& kept) {
    if (kept.empty()) return {};
    std::vector<ArtefactPtr> artefacts;
    for (const auto& [key, artefact] : kept) artefacts.push_back(artefact);
    return write_segment(folder_, label, segment_image(artefacts));
  }

  const fs::path& folder_;
  const KeepSet& needed_;
  bool dry_run_;
  const std::set<DamagedName> damaged_;
  std::size_t removed_ = 0;
  std::map<std::string, Collected::OfStage> stages_;
};

}  // namespace

void KeepSet::add_every_key(std::string_view stage, std::string_view item) {
  items_.emplace(stage, item_label(item));
}

void KeepSet::add_family(std::string_view family, std::string_view item) {
  families_[item_label(item)] = item_label(family);
}

bool KeepSet::covers(std::string_view stage, std::string_view item, const Digest& key) const {
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
  std::map<std::string, Files> families;
  for (SegmentFile& file : list_segments(folder))
    families[file.name.label].segments.push_back(std::move(file));
  for (OldArtefact& old : list_old_artefacts(folder))
    families[needed.family_of(old.label)].old.push_back(std::move(old));
  Collector collector(folder, needed, dry_run);
  std::size_t all = 0;
  for (const auto& [label, files] : families) all += files.size();
  progress.begin("collecting", all);
  for (const auto& [label, files] : families) {
    collector.collect(label, files);
    for (std::size_t left = files.size(); left > 0; --left) progress.item_done();
  }
  progress.end();
  result.stages = collector.stages();
  for (const FolderEntry& entry : list_folder(folder / kDamagedFolder))
    if (!entry.is_folder && is_quarantined(entry.path)) remove_file(entry.path, dry_run, result.damaged);
  visit_abandoned(folder / kScratchFolder,
                  [&](const fs::path& file) { remove_file(file, dry_run, result.unfinished); });
  return result;
}

}  // namespace salbench
