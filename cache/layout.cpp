// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/layout.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "io/digest.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 2;  // raised when the layout of the folder or its file names change
constexpr std::string_view kSuffix = ".h5", kDamaged = ".damaged", kSetFolder = "set", kChecked = "checked";
constexpr std::size_t kShards = 256;
constexpr std::string_view kTagName = "CACHEDIR.TAG";  // backup programs skip folders with this file
constexpr std::string_view kTagSignature = "Signature: 8a477f597d28d172789f06886806bc55";
constexpr std::string_view kFormatLine = "# salbench cache, format ";

std::string tag_text(const fs::path& folder) {
  const auto tag = read_bytes(folder / kTagName);
  return tag ? std::string(reinterpret_cast<const char*>(tag->data()), tag->size()) : std::string();
}

bool is_damaged_segment(std::string_view name) {
  return name.ends_with(kDamaged) && parse_segment_name(name.substr(0, name.size() - kDamaged.size()));
}

std::size_t count_below(const fs::path& folder, bool holds_segments) {
  std::size_t others = 0;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder)
      others += count_below(folder / name, false);
    else if (!holds_segments || !(parse_segment_name(name) || is_damaged_segment(name)))
      ++others;
  });
  return others;
}

template <class IsWanted>
void add_files(const fs::path& folder, const IsWanted& is_wanted, std::vector<fs::path>& files) {
  for (FolderEntry& entry : list_folder(folder))
    if (!entry.is_folder && is_wanted(entry.path.filename().native())) files.push_back(std::move(entry.path));
}

bool is_shard(std::string_view name) { return name.size() == 2 && number_from_hex(name); }

}  // namespace

std::string SegmentName::text() const {
  return fmt::format("{}{}{:016x}{}", label, label.empty() ? "" : ".", checksum, kSuffix);
}

std::optional<SegmentName> parse_segment_name(std::string_view file_name) {
  if (!file_name.ends_with(kSuffix)) return {};
  file_name.remove_suffix(kSuffix.size());
  const std::size_t dot = file_name.rfind('.');
  const std::string_view digits = dot == std::string_view::npos ? file_name : file_name.substr(dot + 1);
  const auto checksum = number_from_hex(digits);
  if (digits.size() != 16 || !checksum) return {};
  return SegmentName{std::string(file_name.substr(0, dot == std::string_view::npos ? 0 : dot)), *checksum};
}

fs::path segment_folder(std::string_view label) {
  if (label.empty()) return kSetFolder;
  Hasher hasher;
  hasher.add(label);
  return segment_folders()[hasher.digest().high >> 56U];
}

const std::vector<fs::path>& segment_folders() {
  static const std::vector<fs::path> folders = [] {
    std::vector<fs::path> all;
    for (std::size_t shard = 0; shard < kShards; ++shard) all.emplace_back(fmt::format("{:02x}", shard));
    all.emplace_back(kSetFolder);
    return all;
  }();
  return folders;
}

bool set_aside(const fs::path& segment) {
  return move_file(segment, segment.native() + std::string(kDamaged));
}

std::int64_t last_check(const fs::path& cache) {
  const auto file = OpenFile::open(cache / kChecked);
  return file ? file->changed_ns() : 0;
}

// Uses the file system's clock, as segments do.
void note_check(const fs::path& cache) try {
  make_folder(cache / kScratchFolder, "");
  UnfinishedFile(cache / kScratchFolder).finish_unsynced(cache / kChecked);
} catch (const StorageError&) {  // the next run then reads more than necessary
}

void forget_check(const fs::path& cache) {
  std::error_code refused;
  fs::remove(cache / kChecked, refused);
}

void check_format(const fs::path& folder) {
  const std::string text = tag_text(folder);
  const std::size_t line = text.find(kFormatLine);
  const int format = line == std::string::npos ? 0 : std::atoi(text.c_str() + line + kFormatLine.size());
  if (format > kFormat)
    throw StorageError(
        fmt::format("{}: written by a newer salbench (cache format {}, this one knows {}); "
                    "use that version, or another folder with {}",
                    folder.string(), format, kFormat, as_option("cache")));
}

bool is_cache(const fs::path& folder) {
  const std::string text = tag_text(folder);
  return text.starts_with(kTagSignature) && text.find(kFormatLine) != std::string::npos;
}

void require_cache(const fs::path& folder) {
  check_format(folder);
  if (!is_cache(folder))
    throw StorageError(fmt::format("{}: not a salbench cache ({} is missing); choose one with {}",
                                   folder.string(), kTagName, as_option("cache")));
}

void prepare_cache(const fs::path& folder) {
  make_folder(folder / kScratchFolder, "choose another cache with " + as_option("cache"));
  // Writing the tag detects a full or read-only folder before any work is done.
  const std::string tag = fmt::format("{}\n{}{}\n", kTagSignature, kFormatLine, kFormat);
  UnfinishedFile file(folder / kScratchFolder);
  file.append(std::as_bytes(std::span(tag)));
  file.finish(folder / kTagName);
}

std::vector<fs::path> list_segments(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& below : segment_folders()) add_files(folder / below, parse_segment_name, files);
  return files;
}

std::vector<fs::path> list_segments(const fs::path& folder, std::string_view label) {
  std::vector<fs::path> files;
  const auto is_of_family = [&](std::string_view file) {
    const auto name = parse_segment_name(file);
    return name && name->label == label;
  };
  add_files(folder / segment_folder(label), is_of_family, files);
  return files;
}

std::vector<fs::path> list_damaged(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& below : segment_folders()) add_files(folder / below, is_damaged_segment, files);
  return files;
}

std::size_t count_other_files(const fs::path& folder) {
  std::size_t others = 0;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder && (is_shard(name) || name == kSetFolder))
      others += count_below(folder / name, true);
    else if (!is_folder && name != kTagName && name != kClaimsFile && name != kChecked)
      ++others;
  });
  return others;
}

}  // namespace salbench
