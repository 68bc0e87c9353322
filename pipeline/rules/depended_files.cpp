// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/depended_files.h"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;

fs::path place_of_depended(const std::string& name, const Section& written) {
  std::error_code missing;
  const fs::path beside = fs::path(written.file()).parent_path() / name;
  return fs::absolute(fs::exists(beside, missing) ? beside : fs::path(name));
}

const std::string& DependedFiles::key_lines() {
  const std::lock_guard lock(mutex_);
  if (!files_.empty()) return lines_;
  std::vector<File> files;
  std::string lines;
  for (const std::string& name : names_) try {
      const fs::path path = place_of_depended(name, written_);
      File& file = files.emplace_back(File{path, {}, identity_of_file(path)});
      file.digest = file_digest(read_file(file.path));
      lines += fmt::format("{}{}: {}\n", kDependsOption, name, file.digest.hex());
    } catch (const InputError& error) {
      written_.fail("depends", fmt::format("names a file that the command needs: {}", error.what()));
    }
  files_ = std::move(files);
  lines_ = std::move(lines);
  return lines_;
}

void DependedFiles::link_into(const fs::path& folder) const {
  for (const std::string& name : names_) {
    if (fs::path(name).is_absolute()) continue;
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    if (!error) fs::create_symlink(place_of_depended(name, written_), folder / name, error);
    if (error)
      throw StorageError(fmt::format("{}: cannot be written to: {}", folder.string(), error.message()));
  }
}

// A file with the same identity is not read again: weights are large, and commands are many.
void DependedFiles::check_unchanged() {
  const std::lock_guard lock(mutex_);
  for (File& file : files_) {
    const std::optional<FileIdentity> identity = identity_of_file(file.path);
    if (identity && identity == file.identity) continue;
    if (file_digest(read_file(file.path)) != file.digest)
      throw InputError(
          fmt::format("{}: changed since this run was planned; run it again", file.path.string()));
    file.identity = identity;
  }
}

}  // namespace salbench
