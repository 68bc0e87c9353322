// SPDX-License-Identifier: GPL-3.0-or-later
// The files that units are read from. What is parsed is what a key names: the digest in a key is that of the
// very bytes that the rule is given.
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

// What a file held when it was read.
struct FileData {
  Digest digest;
  std::variant<std::string, std::vector<double>> content;  // a file's bytes; the values of a part of a file

  const std::string& text() const { return std::get<std::string>(content); }
};

using ReadFile = std::function<FileData()>;  // throws InputError

// Several rules may read it, at the same time.
struct File {
  std::string name;                                // in a key: "mesh file .off", "picks 3": no paths
  std::string place;                               // in messages: its path, or "maps.h5: data set 52"
  std::shared_ptr<const ReadFile> read_with = {};  // nothing: the whole file at `place`
  bool is_read = false;                            // at least once; then, what it held, if it is readable:
  std::optional<Digest> first_digest = {};

  bool is_known() const;  // whether it has been read
  // Of what it held when it was first read, which is now unless it was before; nothing if it is unreadable.
  std::optional<Digest> digest();
  // Throws InputError where it cannot be read, or holds something else than at first.
  FileData read();
};

std::vector<FileData> read_files(std::span<File> files);

// The files of one kind of all units of a level: [unit's index].
using FilesOfUnits = std::shared_ptr<std::vector<std::vector<File>>>;

}  // namespace salbench
