// SPDX-License-Identifier: GPL-3.0-or-later
// Files that units are read from. The digest in a key is computed from the same bytes that the rule parses.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "io/digest.h"

namespace salbench {

// Content of a file at the time of reading.
struct FileData {
  Digest digest;
  std::variant<std::string, std::vector<double>> content;  // bytes of a file, or values of a part of a file

  const std::string& text() const { return std::get<std::string>(content); }
};

using ReadFile = std::function<FileData()>;  // throws InputError

// Several rules may read it concurrently.
struct File {
  std::string name;                                // in keys, without a path: "mesh file .off", "picks 3"
  std::string place;                               // in messages: its path, or "maps.h5: data set 52"
  std::shared_ptr<const ReadFile> read_with = {};  // null: the whole file at `place`
  bool is_read = false;                            // at least once; the next members then describe its
                                                   // content, if it was readable
  std::optional<Digest> first_digest = {};

  bool is_known() const;  // true once it has been read
  // Digest of the content at the first reading, which happens now if there was none; nullopt if unreadable.
  std::optional<Digest> digest();
  // Throws InputError if the file is unreadable, or changed since its first reading.
  FileData read();
};

std::vector<FileData> read_files(std::span<File> files);

// Files of one kind for all units of a level: [unit's index].
using FilesOfUnits = std::shared_ptr<std::vector<std::vector<File>>>;

}  // namespace salbench
