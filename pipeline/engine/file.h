// SPDX-License-Identifier: GPL-3.0-or-later
// The files that units are read from. What is parsed is what a key names: the digest in a key is that of the
// very bytes that the rule was given, whatever the file holds before or afterwards.
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

// One file as it was read.
struct FileData {
  std::optional<Digest> digest;                            // nothing: it could not be read
  std::variant<std::string, std::vector<double>> content;  // a file's bytes; the values of a part of a file
  std::string error = {};                                  // why it could not be read

  const std::string& text() const { return std::get<std::string>(content); }
};

using ReadFile = std::function<FileData()>;  // throws InputError

struct File {
  std::string name;                           // in a key: "mesh file .off", "picks 3": no paths
  std::string place;                          // in messages: its path, or "maps.h5: data set 52"
  std::shared_ptr<const ReadFile> read = {};  // nothing: the whole file at `place`
  bool is_read = false;                       // at least once
  std::optional<Digest> digest = {};          // then, of what it held; nothing if it is unreadable
  std::string title = {};                     // "mesh file 52.off", in messages; empty: the name
};

using FilesOfUnit = std::vector<File>;

// The digests of some files, in the order of the files; nothing stands for one that is unreadable.
using Digests = std::vector<std::optional<Digest>>;

// The files of one kind of all units of a level. Several rules may read them, at the same time: nothing of
// them changes once a run has begun.
struct FileColumn {
  std::vector<FilesOfUnit> files;  // [unit's index]
  bool expected = true;            // of every unit; false: some units are left out
};
using FileColumnPtr = std::shared_ptr<FileColumn>;

// Reads a file that has not been read yet, so that its digest is known; `data` is filled with what it holds.
// Only files that somebody asks for are ever read.
void look(File& file, FileData* data = nullptr);

// Reads the files again, whatever was planned. A warning names one that holds something else by now.
std::vector<FileData> read_again(std::span<const File> files);

// Reads the files, whatever was planned. Throws InputError where one cannot be read.
std::vector<FileData> read_all(std::span<const File> files);

// Reads what has these digests. Throws InputError where one cannot be read or has changed.
std::vector<FileData> read_unchanged(std::span<const File> files, const Digests& digests);

}  // namespace salbench
