// SPDX-License-Identifier: GPL-3.0-or-later
// Files that a model's command needs beside the shape: their content is part of the key of its maps.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/digest.h"
#include "io/file.h"
#include "pipeline/config/section.h"

namespace salbench {

// A key has one option for each such file: this and the file's name, and as its value the file's digest.
inline constexpr std::string_view kDependsOption = "depends on ";

// Where a file lies that is named in a configuration: below the folder of that, or else below the present
// one.
std::filesystem::path place_of_depended(const std::string& name, const Section& written);

class DependedFiles {
 public:
  // Paths as above, or whole ones; `written` is the section whose key `depends` names them.
  DependedFiles(Words names, Section written) : names_(std::move(names)), written_(std::move(written)) {}

  // Lines of a key. Reads the files when first called. Throws ConfigError that names an unreadable one.
  const std::string& key_lines();

  // Links in the folder, by the same names; none to a file that is named by its whole path. Throws
  // StorageError.
  void link_into(const std::filesystem::path& folder) const;

  // Throws InputError if one holds something else by now: a result could be of either.
  void check_unchanged();

 private:
  struct File {
    std::filesystem::path path;
    Digest digest;
    std::optional<FileIdentity> identity;  // before it was last found to hold that
  };

  Words names_;
  Section written_;
  std::mutex mutex_;
  std::vector<File> files_;
  std::string lines_;
};

}  // namespace salbench
