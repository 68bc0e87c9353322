// SPDX-License-Identifier: GPL-3.0-or-later
// Caches of salbench 1.0, which had a file per artefact:
//   <stage>/<2 digits>/<item>.<key>.<content>.<checksum>.<size>.h5
// Such a file is read as a segment of one artefact (cache/segment.h), and `gc` turns them into segments. A
// remark was an artefact of its own, whose key is made of that of the result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact.h"

namespace salbench {

struct OldArtefact {
  std::filesystem::path path;
  std::string stage, label;  // of the item
  Digest key, content;
  std::uint64_t checksum = 0, size = 0;  // of the file
};

// By the file's place and name; nothing if it is another's.
std::optional<OldArtefact> old_artefact_at(const std::filesystem::path& file);

// By path, remarks among them. Throws StorageError if a folder cannot be listed to its end.
std::vector<std::filesystem::path> list_old_artefacts(const std::filesystem::path& folder);

inline constexpr std::string_view kOldRemarks = "remark";          // their stage
Digest old_remark_key(std::string_view stage, const Digest& key);  // of the remark on a result
std::string old_remark(const Artefact& remark);

// Nothing: there is no such file. Throws InputError where it is damaged, StorageError where it cannot be
// read.
std::optional<Artefact> read_old_artefact(const OldArtefact& old);

}  // namespace salbench
