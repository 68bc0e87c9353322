// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/depended_files.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_to_write(const fs::path& path, const std::error_code& error) {
  throw StorageError(
      fmt::format("{}: cannot be written: {}; set TMPDIR to another", path.string(), error.message()));
}

[[noreturn]] void fail_of_change(const fs::path& path) {
  throw InputError(fmt::format("{}: changed since this run was planned; run it again", path.string()));
}

// As "No module named 'helper'" does of helper.py, and "/tmp/x/weights.txt: No such file" of weights.txt.
bool speaks_of(std::string_view text, const fs::path& file) {
  const auto is_between = [&](std::string_view word, std::string_view before, std::string_view after) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; ++at) {
      const std::size_t end = at + word.size();
      if (at > 0 && before.find(text[at - 1]) != std::string_view::npos &&
          (end == text.size() || after.find(text[end]) != std::string_view::npos))
        return true;
    }
    return false;
  };
  return is_between(file.string(), " '\"/", "'\"/:") || is_between(file.stem().string(), "'", "'.");
}

}  // namespace

fs::path place_of_depended(const std::string& name, const Section& written) {
  std::error_code missing;
  const fs::path beside = fs::path(written.folder()) / name;
  return fs::absolute(fs::exists(beside, missing) ? beside : fs::path(name));
}

bool names_file(const Words& names, const std::string& name) {
  const fs::path plain = fs::path(name).lexically_normal();
  return std::ranges::any_of(
      names, [&](const std::string& one) { return fs::path(one).lexically_normal() == plain; });
}

DependedFiles::DependedFiles(const Words& names, Section written) : written_(std::move(written)) {
  for (const std::string& name : names)
    if (!names_file(names_, name)) names_.push_back(name);
}

const std::string& DependedFiles::key_lines() {
  const std::lock_guard lock(mutex_);
  if (!files_.empty()) return lines_;
  std::vector<File> files;
  std::string lines;
  for (const std::string& name : names_) try {
      const fs::path path = place_of_depended(name, written_);
      File& file = files.emplace_back(File{name, path, {}, identity_of_file(path)});
      file.digest = file_digest(read_file(file.path));
      lines += fmt::format("{}{}: {}\n", kDependsOption, name, file.digest.hex());
    } catch (const InputError& error) {
      written_.fail("depends", fmt::format("names a file that the command needs: {}", error.what()));
    }
  files_ = std::move(files);
  lines_ = std::move(lines);
  return lines_;
}

// With the time of the original, so that whatever is written into a copy changes it.
void DependedFiles::copy_all() {
  auto copies = std::make_unique<ScratchFolder>();
  std::vector<File> files = files_;
  for (File& file : files) {
    if (fs::path(file.name).is_absolute()) continue;
    file.copy = copies->path() / std::to_string(&file - files.data());
    std::error_code error;
    fs::copy_file(file.path, file.copy, error);
    if (!error) file.copied = fs::last_write_time(file.path, error);
    if (!error) fs::last_write_time(file.copy, file.copied, error);
    if (error) fail_to_write(file.copy, error);
    if (file_digest(read_file(file.copy)) != file.digest) fail_of_change(file.path);
  }
  files_ = std::move(files);
  copies_ = std::move(copies);
}

void DependedFiles::put_into(const fs::path& folder) {
  key_lines();
  check_unchanged();
  const std::lock_guard lock(mutex_);
  if (!copies_) copy_all();
  for (const File& file : files_) {
    if (file.copy.empty()) continue;
    const fs::path place = folder / fs::path(file.name).lexically_normal();
    std::error_code error, no_links;
    fs::create_directories(place.parent_path(), error);
    fs::create_hard_link(file.copy, place, no_links);
    if (!error && no_links) fs::copy_file(file.copy, place, error);
    if (error) fail_to_write(place, error);
  }
}

// A file with the same identity is not read again: weights are large, and commands are many.
void DependedFiles::check_unchanged() {
  const std::lock_guard lock(mutex_);
  for (File& file : files_) {
    if (!file.copy.empty()) {
      std::error_code gone;
      if (fs::last_write_time(file.copy, gone) == file.copied && !gone) continue;
      throw InputError(fmt::format(
          "{}: the command has written into its copy of this file, which is that of the other shapes, too: "
          "let it write into another",
          file.name));
    }
    const std::optional<FileIdentity> identity = identity_of_file(file.path);
    if (identity && identity == file.identity) continue;
    if (file_digest(read_file(file.path)) != file.digest) fail_of_change(file.path);
    file.identity = identity;
  }
}

std::string DependedFiles::left_out_of(std::string_view text) const {
  const auto holds_some = [&](const std::string& folder) {
    return std::ranges::any_of(names_,
                               [&](const std::string& name) { return name.starts_with(folder + '/'); });
  };
  for (const std::string& name : names_) {
    if (fs::path(name).is_absolute()) continue;
    std::error_code ignored;
    const fs::path folder = place_of_depended(name, written_).parent_path();
    for (fs::directory_iterator it(folder, ignored), end; !ignored && it != end; it.increment(ignored)) {
      const std::string beside = (fs::path(name).parent_path() / it->path().filename()).string();
      if (!names_file(names_, beside) && !holds_some(beside) && speaks_of(text, it->path().filename()))
        return fmt::format("; {} is not in the command's folder: add {} to depends", beside,
                           it->is_directory(ignored) ? "its files" : "it");
    }
  }
  return {};
}

}  // namespace salbench
