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

constexpr int kFormat = 2;  // raised when the layout of the folder or of its names changes
constexpr std::string_view kSuffix = ".h5", kSetFolder = "set";
constexpr std::size_t kShards = 256;
constexpr std::string_view kTagName = "CACHEDIR.TAG";  // backup programs skip folders that hold it
constexpr std::string_view kTagSignature = "Signature: 8a477f597d28d172789f06886806bc55";
constexpr std::string_view kFormatLine = "# salbench cache, format ";

std::string tag_text(const fs::path& folder) {
  const auto tag = read_bytes(folder / kTagName);
  return tag ? std::string(reinterpret_cast<const char*>(tag->data()), tag->size()) : std::string();
}

std::size_t count_below(const fs::path& folder, bool holds_segments) {
  std::size_t others = 0;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder)
      others += count_below(folder / name, false);
    else if (!holds_segments || !parse_segment_name(name))
      ++others;
  });
  return others;
}

void add_segments(const fs::path& folder, std::vector<fs::path>& files) {
  for (FolderEntry& entry : list_folder(folder))
    if (!entry.is_folder && parse_segment_name(entry.path.filename().native()))
      files.push_back(std::move(entry.path));
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

std::optional<DamagedName> parse_damaged_name(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string_view::npos || !parse_segment_name(file_name.substr(0, dot))) return {};
  const auto key = digest_from_hex(file_name.substr(dot + 1));
  return key ? std::optional(DamagedName{std::string(file_name.substr(0, dot)), *key}) : std::nullopt;
}

std::set<DamagedName> list_damaged(const fs::path& folder) {
  std::set<DamagedName> damaged;
  visit_names(folder / kDamagedFolder, [&](std::string_view name, bool is_folder) {
    if (auto known = is_folder ? std::nullopt : parse_damaged_name(name)) damaged.insert(std::move(*known));
  });
  return damaged;
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

bool is_own_name(std::string_view name) {
  return name == kScratchFolder || name == kDamagedFolder || name == kTagName || name == kClaimsFile ||
         name == kSetFolder || is_shard(name);
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
  // Writing the tag each time is the probe for a full or read-only folder, before any work is done.
  const std::string tag = fmt::format("{}\n{}{}\n", kTagSignature, kFormatLine, kFormat);
  UnfinishedFile file(folder / kScratchFolder);
  file.append(std::as_bytes(std::span(tag)));
  file.finish(folder / kTagName);
}

std::vector<fs::path> list_segments(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& below : segment_folders()) add_segments(folder / below, files);
  return files;
}

std::vector<fs::path> list_segments(const fs::path& folder, std::string_view label) {
  std::vector<fs::path> files;
  add_segments(folder / segment_folder(label), files);
  std::erase_if(files, [&](const fs::path& file) {
    return parse_segment_name(file.filename().native())->label != label;
  });
  return files;
}

std::size_t count_other_files(const fs::path& folder) {
  std::size_t others = 0;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder && (is_shard(name) || name == kSetFolder))
      others += count_below(folder / name, true);
    else if (!is_folder && !is_own_name(name))
      ++others;
  });
  return others;
}

}  // namespace salbench
