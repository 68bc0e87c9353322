// SPDX-License-Identifier: GPL-3.0-or-later
// Empty folders stay: another process may be about to rename a segment into one. If a run misses a segment
// that was removed, it searches the family's other segments for the contents.
#include "cache/collect.h"

#include <map>
#include <utility>

#include <spdlog/spdlog.h>

#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kManySegments = 8;             // per family: more are merged
constexpr std::uintmax_t kMostReplaced = 1U << 30U;  // bytes that may be on the disk twice

// A file that disappeared in the meantime is ignored.
void remove_file(const fs::path& file, bool dry_run, Amount& amount) {
  const auto size = size_of_file(file);
  if (!size) return;
  if (!dry_run) salbench::remove_file(file);
  amount.add(*size);
}

class Collector {
 public:
  Collector(const fs::path& folder, const KeepSet& needed, bool dry_run)
      : folder_(folder), needed_(needed), dry_run_(dry_run) {}

  // Collects the files of one family. True if they must be rewritten, which happens after all removals, since
  // a disk may be full.
  bool collect(const std::vector<fs::path>& files) {
    const std::size_t removed_before = removed_;
    std::set<Digest> keys;
    bool has_copies = false;  // several artefacts of one key
    std::size_t segments = 0;
    for (const fs::path& file : files)
      if (const auto segment = Segment::open(file)) {
        ++segments;
        for (const SegmentRow& row : segment->rows())
          if (count(row)) has_copies |= !keys.insert(row.key).second;
      }
    if (removed_ == removed_before && !has_copies && segments < kManySegments) return false;
    if (!keys.empty()) return true;
    if (!dry_run_) {
      rewrite({}, files);
      remove_replaced();
    }
    return false;
  }

  // Writes the needed artefacts of a family's files to one file. remove_replaced removes the old ones.
  void rewrite(const std::string& label, const std::vector<fs::path>& files) {
    Segments segments;
    for (const fs::path& file : files)
      if (auto segment = Segment::open(file)) segments.emplace_back(file, std::move(*segment));
    Artefacts kept = read(segments);
    const fs::path written = write(label, std::move(kept));
    if (!written.empty()) written_.push_back(written);
    for (const auto& [path, segment] : segments) {
      if (path == written) continue;
      replaced_.push_back(path);
      replaced_bytes_ += size_of_file(path).value_or(0);
    }
    if (replaced_bytes_ > kMostReplaced) remove_replaced();
  }

  // Removes old files after their replacements are on the disk: a power cut loses neither.
  void remove_replaced() {
    for (const fs::path& path : written_) sync_file(path);
    for (const fs::path& path : replaced_) salbench::remove_file(path);
    written_.clear();
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

  bool count(const SegmentRow& row) {
    Collected::OfStage& of_stage =
        stages_.try_emplace(row.stage, Collected::OfStage{row.stage, {}, {}}).first->second;
    const bool is_needed = needed_.covers(row.stage, row.item, row.key);
    (is_needed ? of_stage.kept : of_stage.removed).add(row.bytes);
    removed_ += is_needed ? 0U : 1U;
    return is_needed;
  }

  // The needed artefacts by key. Among several artefacts with one key, this takes the one that a run would
  // load (EntryTable::find).
  Artefacts read(const Segments& segments) const {
    Artefacts found;
    for (const auto& [path, segment] : segments)
      for (const SegmentRow& row : segment.rows()) {
        if (!needed_.covers(row.stage, row.item, row.key)) continue;
        const auto known = found.find(row.key);
        if (known != found.end() && known->second.content <= row.content) continue;
        if (auto artefact = segment.read(row, Segment::Part::all))
          found.insert_or_assign(row.key, std::move(*artefact));
      }
    return found;
  }

  fs::path write(const std::string& label, Artefacts&& kept) {
    if (kept.empty()) return {};
    std::vector<ArtefactPtr> artefacts;
    for (auto& [key, artefact] : kept)
      artefacts.push_back(std::make_shared<const Artefact>(std::move(artefact)));
    const SegmentImage image = segment_image(artefacts);
    try {
      return write_segment(folder_, label, image);
    } catch (const StorageError&) {  // a full disk has room again without what was replaced
      if (replaced_.empty()) throw;
      remove_replaced();
      return write_segment(folder_, label, image);
    }
  }

  const fs::path& folder_;
  const KeepSet& needed_;
  bool dry_run_;
  std::size_t removed_ = 0;
  std::map<std::string, Collected::OfStage> stages_;
  std::vector<fs::path> written_, replaced_;  // since the last removal
  std::uintmax_t replaced_bytes_ = 0;
};

}  // namespace

void KeepSet::add_every_key(std::string_view stage, std::string_view item) {
  items_.emplace(stage, item_label(item));
}

bool KeepSet::covers(std::string_view stage, std::string_view item, const Digest& key) const {
  if (!dropped_.empty()) return !dropped_.contains(stage);
  return keys_.contains(key) || items_.contains({std::string(stage), item_label(item)});
}

namespace {

// Segments without damage, each read to its end; removes the others.
std::vector<fs::path> sound_segments(const fs::path& folder, bool dry_run, Amount& damaged,
                                     Progress& progress) {
  std::vector<fs::path> files = list_segments(folder);
  std::vector<std::string> faults(files.size());
  progress.begin("checking", files.size());
  parallel_ranges(files.size(), 1, [&](std::size_t i, std::size_t) {
    faults[i] = damage_in(files[i]);
    progress.item_done();
  });
  progress.end();
  std::vector<fs::path> sound;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (faults[i].empty()) {
      sound.push_back(std::move(files[i]));
      continue;
    }
    spdlog::warn("{}: {}; {}", files[i].string(), faults[i], dry_run ? "would be removed" : "removed");
    remove_file(files[i], dry_run, damaged);
  }
  return sound;
}

}  // namespace

Collected collect_garbage(const fs::path& folder, const KeepSet& needed, bool dry_run, Progress& progress) {
  require_cache(folder);
  Collected result;
  std::map<std::string, std::vector<fs::path>> families;
  for (const fs::path& file : sound_segments(folder, dry_run, result.damaged, progress))
    families[parse_segment_name(file.filename().native())->label].push_back(file);
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
  for (const fs::path& file : list_damaged(folder)) remove_file(file, dry_run, result.damaged);
  visit_abandoned(folder / kScratchFolder,
                  [&](const fs::path& file) { remove_file(file, dry_run, result.unfinished); });
  return result;
}

}  // namespace salbench
