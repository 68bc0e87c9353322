// SPDX-License-Identifier: GPL-3.0-or-later
// Files that a model's command needs beside the shape: their content is part of the key of its maps.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/commands/scratch_folder.h"
#include "io/digest.h"
#include "io/file.h"
#include "pipeline/config/section.h"

namespace salbench {

// A key has one option for each such file: this and the file's name, and as its value the file's digest.
inline constexpr std::string_view kDependsOption = "depends on ";

// Where a file lies that is named in a configuration: below the folder of that, or else below the present
// one.
std::filesystem::path place_of_depended(const std::string& name, const Section& written);

// True if one of them is this name, however it is spelt: "./a.py" is "a.py".
bool names_file(const Words& names, const std::string& name);

class DependedFiles {
 public:
  // Paths as above, or whole ones; `written` is the section whose key `depends` names them. What is named
  // twice counts once.
  DependedFiles(const Words& names, Section written);

  // Lines of a key. Reads the files when first called. Throws ConfigError that names an unreadable one.
  const std::string& key_lines();

  // Puts them into the folder, by the same names; none that is named by its whole path. They are copies, so
  // that nothing beside the originals is found from there, and nothing is written into these. Throws
  // StorageError, and InputError for one that has changed since it was planned.
  void put_into(const std::filesystem::path& folder);

  // Throws InputError if one holds something else by now: a result could be of either.
  void check_unchanged();

  // "; helper.py is not in the command's folder ...", if a text of a command that failed speaks of a file
  // that lies beside one of them and is none of them; empty otherwise.
  std::string left_out_of(std::string_view text) const;

 private:
  struct File {
    std::string name;
    std::filesystem::path path;
    Digest digest;
    std::optional<FileIdentity> identity;  // before it was last found to hold that
    std::filesystem::path copy = {};       // empty: none, the original is read
    std::filesystem::file_time_type copied = {};
  };
  void copy_all();

  Words names_;
  Section written_;
  std::mutex mutex_;
  std::vector<File> files_;
  std::string lines_;
  std::unique_ptr<ScratchFolder> copies_;  // one of each for the whole run: weights may be gigabytes
};

}  // namespace salbench
