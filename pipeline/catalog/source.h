// SPDX-License-Identifier: GPL-3.0-or-later
// The files that items are read from. What is parsed is what a key names: the digest in a key is that of the
// very bytes that the stage was given, whatever the file holds before or afterwards.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cache/digest.h"
#include "io/dataset.h"
#include "stages/core/types.h"

namespace salbench {

// One file as it was read.
struct SourceData {
  Digest digest;
  std::variant<std::string, ScalarField> content;  // a file's bytes; the values of a data set within a file

  const std::string& text() const { return std::get<std::string>(content); }
};

struct SourceFile {
  std::string name;                   // in a key: "mesh file .off", "picks 3": no paths
  std::string place;                  // in messages: its path, or "maps.h5: data set 52"
  std::function<SourceData()> read;   // throws InputError
  std::optional<Digest> digest = {};  // of what it held when it was last read; nothing if it is unreadable
  std::string error = {};             // then: why
};

using SourceFiles = std::vector<SourceFile>;

// All three read the file once, for its digest, and hand out what they read where `data` is given.
SourceFile source_file(std::string name, const std::filesystem::path& path, SourceData* data = nullptr);
SourceFile source_file(std::string name, std::string place, std::function<SourceData()> read,
                       SourceData* data = nullptr);

SourceFile mesh_file_of(const DatasetItem& item, SourceData* data = nullptr);

// Reads the files again. Where one holds something else by now, its digest follows it, with a warning that
// names it; the data of a file that cannot be read are empty.
std::vector<SourceData> read_again(SourceFiles& files);

// Reads them as they were planned. Throws InputError where one cannot be read or has changed.
std::vector<SourceData> read_unchanged(const SourceFiles& files);

}  // namespace salbench
