// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/folder_store.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using Entry = EntryTable::Entry;

// Limits on a family's unsaved results: the seconds of work that a killed process can lose, and memory.
constexpr double kMostUnsavedSeconds = 5;
constexpr std::uint64_t kMostUnsavedBytes = 8U << 20U;
constexpr std::int64_t kTrustsAll = std::numeric_limits<std::int64_t>::max();

using VisitNote = FolderStore::VisitNote;
using RowsOfKeys = std::vector<std::pair<std::uint64_t, Digest>>;

// Skips damaged rows; load() reports them.
void visit_row(const Segment& segment, std::uint64_t row, const Digest& key, const VisitNote& visit) try {
  if (row >= segment.rows().size() || segment.rows()[row].key != key) return;
  if (const auto artefact = segment.read(segment.rows()[row], Segment::Part::record))
    visit(key, artefact->note);
} catch (const InputError&) {
}

void visit_rows(const fs::path& file, const RowsOfKeys& rows, const VisitNote& visit) try {
  const std::optional<Segment> segment = Segment::open(file);
  if (!segment) return;
  for (const auto& [row, key] : rows) visit_row(*segment, row, key, visit);
} catch (const InputError&) {
}

}  // namespace

struct FolderStore::Impl {
  struct Unsaved {
    std::vector<ArtefactPtr> artefacts;
    double seconds = 0;
    std::uint64_t bytes = 0;

    bool is_much() const { return seconds >= kMostUnsavedSeconds || bytes >= kMostUnsavedBytes; }
  };

  Impl(fs::path the_folder, Access the_access) : folder(std::move(the_folder)), access(the_access) {}

  fs::path folder;
  Access access;
  EntryTable entries;
  mutable std::shared_mutex mutex;                      // guards the containers below
  std::vector<fs::path> files;                          // [number]
  std::set<std::string, std::less<>> names;             // names of `files`
  std::map<std::string, Unsaved, std::less<>> unsaved;  // by label
  std::unordered_map<Digest, ArtefactPtr> kept;         // unsaved artefacts and those being written
  std::unordered_map<Digest, std::string> remarks;      // few artefacts have one
  std::mutex preparing;  // std::call_once would hang under ThreadSanitizer if preparing throws
  bool prepared = false;
  std::atomic<bool> any_checked = false;
  bool has_all_families = true;  // false for a share
  std::atomic<bool> any_saved = false;

  // A file and the rows in its head.
  struct Listed {
    fs::path path;
    std::vector<SegmentRow> rows;
  };

  // Adds files that are not yet known; in batches, since other threads wait.
  void add(const std::vector<Listed>& listed) {
    std::vector<EntryTable::Row> found;
    {
      const std::unique_lock lock(mutex);
      for (const auto& [path, rows] : listed) {
        const std::string name = path.filename();
        if (!names.insert(name).second) continue;
        const auto number = static_cast<std::uint32_t>(files.size());
        files.push_back(path);
        for (std::uint32_t i = 0; i < rows.size(); ++i) {
          const SegmentRow& row = rows[i];
          found.push_back({row.stage, row.item, row.key, {row.content, row.bytes, number, i}});
          if (!row.remark.empty()) remarks[row.key] = row.remark;
        }
      }
    }
    entries.insert(found);
  }

  // Renames a damaged segment if allowed. True if it was renamed, so that nothing in it can be found.
  bool lose(const fs::path& path, std::string_view why) const {
    const bool is_lost = access == Access::read_write && set_aside(path);
    spdlog::warn("{}: {}; {}", path.string(), why,
                 is_lost                        ? "renamed to *.damaged, and what was in it is computed again"
                 : access == Access::read_write ? "it cannot be renamed to *.damaged, and is a miss"
                                                : "a run will compute what was in it again");
    return is_lost;
  }

  // Segments that changed since `trusted_before_ns` are read to their end.
  std::optional<Listed> read_head(const fs::path& path, std::int64_t trusted_before_ns) try {
    const std::optional<Segment> segment = Segment::open(path);
    if (!segment) return {};
    if (segment->changed_ns() >= trusted_before_ns) {
      any_checked = true;
      segment->check();
    }
    return Listed{path, segment->rows()};
  } catch (const InputError& error) {
    lose(path, error.what());
    return {};
  }

  template <class IsWanted>
  void list(const fs::path& below, std::int64_t trusted_before_ns, const IsWanted& is_wanted) {
    std::vector<fs::path> found;
    visit_names(folder / below, [&](std::string_view file, bool is_folder) {
      const auto name = is_folder ? std::nullopt : parse_segment_name(file);
      if (name && is_wanted(*name)) found.push_back(folder / below / file);
    });
    {
      const std::shared_lock lock(mutex);
      std::erase_if(found, [&](const fs::path& path) { return names.contains(path.filename().native()); });
    }
    std::vector<Listed> listed;
    for (const fs::path& path : found)
      if (auto head = read_head(path, trusted_before_ns)) listed.push_back(std::move(*head));
    add(listed);
  }

  void refresh(const std::string& label) {
    list(segment_folder(label), kTrustsAll, [&](const SegmentName& name) { return name.label == label; });
  }

  // Dominates the time of a run without open jobs.
  void list_all(const std::optional<std::vector<std::string>>& families) {
    std::set<std::string, std::less<>> labels = {""};
    for (const std::string& family : families.value_or(std::vector<std::string>()))
      labels.insert(item_label(family));
    const std::vector<fs::path>& folders = segment_folders();
    // Segments are fully checked only if damaged ones can be renamed.
    const bool may_rename = access == Access::read_write && ::access(folder.c_str(), W_OK) == 0;
    const std::int64_t trusted_before_ns = may_rename ? last_check(folder) : kTrustsAll;
    parallel_ranges(folders.size(), 1, [&](std::size_t i, std::size_t) {
      list(folders[i], trusted_before_ns,
           [&](const SegmentName& name) { return !families || labels.contains(name.label); });
    });
    has_all_families = !families;
    if (any_checked && has_all_families) note_check(folder);
  }

  fs::path file(std::uint32_t number) const {
    const std::shared_lock lock(mutex);
    return files[number];
  }

  ArtefactPtr kept_artefact(const Digest& key) const {
    const std::shared_lock lock(mutex);
    const auto found = kept.find(key);
    return found == kept.end() ? nullptr : found->second;
  }

  // nullopt if the artefact is gone. Throws InputError if the file was replaced.
  static std::optional<std::pair<Segment, SegmentRow>> located(const fs::path& file, const Entry& entry,
                                                               const Digest& key) {
    std::optional<Segment> segment = Segment::open(file);
    if (!segment) return {};
    if (entry.row >= segment->rows().size() || segment->rows()[entry.row].key != key)
      throw InputError("it is not the file of this name");
    const SegmentRow row = segment->rows()[entry.row];
    return std::pair(std::move(*segment), row);
  }

  // Returns the first undamaged artefact of the key; several files may contain the key.
  std::optional<Artefact> read(const Digest& key) {
    if (const ArtefactPtr artefact = kept_artefact(key)) return *artefact;
    std::optional<std::string> moved;  // label of a missing segment
    for (const Entry& entry : entries.find(key)) {
      const fs::path path = file(entry.file);
      std::optional<std::pair<Segment, SegmentRow>> found;
      try {
        found = located(path, entry, key);
        if (found) return found->first.read(found->second, Segment::Part::all);
        moved = parse_segment_name(path.filename().native())->label;
      } catch (const InputError& error) {
        const std::string what =
            found ? fmt::format("{} of {}: ", found->second.stage, found->second.item) : "";
        if (lose(path, what + error.what()) && found) erase_rows(found->first, entry.file);
      }
      entries.erase(key, entry);
    }
    if (moved) {  // another process may have rewritten it
      refresh(*moved);
      if (!entries.find(key).empty()) return read(key);
    }
    return {};
  }

  void erase_rows(const Segment& segment, std::uint32_t number) {
    std::uint32_t i = 0;
    for (const SegmentRow& row : segment.rows())
      entries.erase(row.key, {row.content, row.bytes, number, i++});
  }

  Unsaved take(const std::string& label) {
    const std::unique_lock lock(mutex);
    const auto found = unsaved.extract(std::string(label));
    return found ? std::move(found.mapped()) : Unsaved();
  }

  void write(const std::string& label, const std::vector<ArtefactPtr>& artefacts) {
    const fs::path path = write_segment(folder, label, segment_image(artefacts));
    any_saved = true;
    {  // equal contents have equal names
      const std::unique_lock lock(mutex);
      names.erase(path.filename().string());
    }
    std::vector<SegmentRow> rows;
    for (const ArtefactPtr& artefact : artefacts) rows.push_back(row_of(*artefact));
    add({Listed{path, std::move(rows)}});
    const std::unique_lock lock(mutex);
    for (const ArtefactPtr& artefact : artefacts)
      if (const auto found = kept.find(artefact->key); found != kept.end() && found->second == artefact)
        kept.erase(found);
  }

  void flush(const std::string& label) {
    const Unsaved all = take(label);
    if (!all.artefacts.empty()) write(label, all.artefacts);
  }
};

FolderStore::FolderStore(fs::path folder, Access access,
                         const std::optional<std::vector<std::string>>& families)
    : impl_(std::make_unique<Impl>(std::move(folder), access)) {
  std::error_code error;
  if (fs::exists(impl_->folder, error) && !fs::is_directory(impl_->folder, error))
    throw StorageError(fmt::format("{}: is not a folder; choose another with {}", impl_->folder.string(),
                                   as_option("cache")));
  check_format(impl_->folder);
  if (access == Access::read_write)
    visit_abandoned(impl_->folder / kScratchFolder, [&](const fs::path& file) { fs::remove(file, error); });
  impl_->list_all(families);
}

FolderStore::~FolderStore() = default;

std::optional<Digest> FolderStore::find(const Digest& key) const {
  if (const ArtefactPtr artefact = impl_->kept_artefact(key)) return artefact->content;
  const std::vector<Entry> found = impl_->entries.find(key);
  return found.empty() ? std::nullopt : std::optional(found.front().content);
}

bool FolderStore::has_item(std::string_view stage, std::string_view item) const {
  return impl_->entries.has_item(stage, item);
}

std::vector<std::string> FolderStore::stages() const { return impl_->entries.stages(); }

void FolderStore::refresh(std::string_view family) { impl_->refresh(item_label(family)); }

std::optional<Artefact> FolderStore::artefact(const Digest& key) { return impl_->read(key); }

std::optional<Arrays> FolderStore::load(const Digest& key) {
  const std::optional<Artefact> found = artefact(key);
  return found ? std::optional(arrays_of(*found)) : std::nullopt;
}

std::string FolderStore::remark(const Digest& key) {
  if (const ArtefactPtr artefact = impl_->kept_artefact(key)) return artefact->note.remark;
  const std::shared_lock lock(impl_->mutex);
  const auto found = impl_->remarks.find(key);
  return found == impl_->remarks.end() ? std::string() : found->second;
}

void FolderStore::prepare() {
  const std::lock_guard lock(impl_->preparing);
  if (!impl_->prepared) prepare_cache(impl_->folder);
  impl_->prepared = true;
}

void FolderStore::save(std::string_view family, Artefact artefact) {
  prepare();
  const std::string label = item_label(family);
  artefact.note.attributes.insert(artefact.note.attributes.begin(),
                                  {"program", fmt::format("salbench {}", SALBENCH_VERSION)});
  const ArtefactPtr kept = std::make_shared<const Artefact>(std::move(artefact));
  bool is_much = false;
  {
    const std::unique_lock lock(impl_->mutex);
    Impl::Unsaved& unsaved = impl_->unsaved[label];
    unsaved.artefacts.push_back(kept);
    unsaved.seconds += kept->note.seconds;
    unsaved.bytes += salbench::bytes_of(*kept);
    impl_->kept[kept->key] = kept;
    is_much = unsaved.is_much();
  }
  if (is_much) impl_->flush(label);
}

void FolderStore::flush(std::string_view family) { impl_->flush(item_label(family)); }

void FolderStore::flush_all() {
  std::vector<std::string> labels;
  {
    const std::shared_lock lock(impl_->mutex);
    for (const auto& [label, unsaved] : impl_->unsaved) labels.push_back(label);
  }
  for (const std::string& label : labels) impl_->flush(label);
  if (impl_->any_saved.exchange(false) && impl_->has_all_families) note_check(impl_->folder);
}

std::unique_ptr<Claim> FolderStore::claim(std::string_view work) { return claim_in(impl_->folder, work); }
bool FolderStore::is_claimed(std::string_view work) const { return is_claimed_in(impl_->folder, work); }

std::optional<FolderStore::Location> FolderStore::location(const Digest& key) const {
  for (const Entry& entry : impl_->entries.find(key))
    if (const auto found = Impl::located(impl_->file(entry.file), entry, key))
      return Location{impl_->file(entry.file), found->first.group(found->second)};
  return {};
}

std::optional<fs::path> FolderStore::file_of(const Digest& key) const {
  const std::vector<Entry> found = impl_->entries.find(key);
  return found.empty() ? std::nullopt : std::optional(impl_->file(found.front().file));
}

std::optional<std::uint64_t> FolderStore::bytes_of(const Digest& key) const {
  if (const ArtefactPtr artefact = impl_->kept_artefact(key)) return salbench::bytes_of(*artefact);
  const std::vector<Entry> found = impl_->entries.find(key);
  return found.empty() ? std::nullopt : std::optional(found.front().bytes);
}

void FolderStore::visit_notes(const std::vector<Digest>& keys, const VisitNote& visit) const {
  std::map<std::uint32_t, RowsOfKeys> rows;  // by file, to open each once
  for (const Digest& key : keys) {
    if (const ArtefactPtr artefact = impl_->kept_artefact(key)) {
      visit(key, artefact->note);
      continue;
    }
    for (const Entry& entry : impl_->entries.find(key)) rows[entry.file].emplace_back(entry.row, key);
  }
  for (const auto& [file, of_file] : rows) visit_rows(impl_->file(file), of_file, visit);
}

std::vector<FolderStore::Usage> FolderStore::usage() const { return impl_->entries.usage(); }

}  // namespace salbench
