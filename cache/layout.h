// SPDX-License-Identifier: GPL-3.0-or-later
// Contents of a cache folder:
//   CACHEDIR.TAG           what makes a folder a cache; holds the format
//   <stage>/<2 digits>/    artefacts, by the first digits of the key
//   tmp/                   files being written
//   damaged/               quarantined artefacts
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact_name.h"

namespace salbench {

inline constexpr std::string_view kScratchFolder = "tmp";
inline constexpr std::string_view kDamagedFolder = "damaged";
inline constexpr std::string_view kClaimsFile = "claims";  // empty; see claim.cpp

inline constexpr std::size_t kShards = 256;  // of a stage
inline std::size_t shard_number(const Digest& key) { return key.high >> 56U; }
inline Digest first_key(std::size_t shard) { return {shard << 56U, 0}; }

// The folder of an artefact, below the cache's.
std::filesystem::path shard_of(std::string_view stage, const Digest& key);

// Throws StorageError if a newer program wrote the folder; a folder without a tag passes.
void check_format(const std::filesystem::path& folder);

// True of a folder that a salbench, this one or another, made as a cache.
bool is_cache(const std::filesystem::path& folder);

// Throws StorageError unless the folder is a cache that this program knows. Called before files are inspected
// or removed, so that a mistyped folder is left alone.
void require_cache(const std::filesystem::path& folder);

// Makes the folder a cache. Throws StorageError if it cannot be written to.
void prepare_cache(const std::filesystem::path& folder);

// A folder of artefacts.
struct ShardFolder {
  std::string stage;
  std::string name;           // two digits, unless it is not the cache's
  std::size_t artefacts = 0;  // at least one
};

struct CacheListing {
  std::vector<ShardFolder> shards;  // by path
  std::size_t artefacts = 0;
  std::size_t others = 0;  // files that are neither artefacts nor the cache's own
};

struct ArtefactFile {
  std::filesystem::path path;
  std::string stage;
  ArtefactName name;
};

// All three throw StorageError if a folder cannot be listed to its end; a missing folder is empty.
std::vector<std::string> list_stages(const std::filesystem::path& folder);
CacheListing list_cache(const std::filesystem::path& folder);
std::vector<ArtefactFile> list_shard(const std::filesystem::path& folder,
                                     const ShardFolder& shard);  // by path

// Artefacts of one key; several if the stage is not deterministic. Reads only the names of files.
std::vector<ArtefactName> find_artefacts(const std::filesystem::path& folder, std::string_view stage,
                                         const Digest& key);

}  // namespace salbench
