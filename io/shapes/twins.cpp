// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/twins.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// "a.off and a.ply"; with their folders where these alone differ.
std::string file_names(const std::vector<fs::path>& files) {
  const bool in_one_folder = std::ranges::all_of(
      files, [&](const fs::path& file) { return file.parent_path() == files[0].parent_path(); });
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const fs::path& file : files)
    names.push_back(in_one_folder ? file.filename().string() : file.string());
  return fmt::format("{}", fmt::join(names, " and "));
}

std::ptrdiff_t count_of(std::string_view extension, const std::vector<fs::path>& files) {
  return std::count_if(files.begin(), files.end(), [&](const fs::path& file) {
    return lower_case_extension(file).substr(1) == extension;
  });
}

// An extension that one of the files has alone; empty if there is none.
std::string telling_extension(const std::vector<fs::path>& files) {
  for (const fs::path& file : files)
    if (std::string extension = lower_case_extension(file).substr(1); count_of(extension, files) == 1)
      return extension;
  return {};
}

bool is_kept(const fs::path& file, Twins kept) {
  return kept != Twins::refuse && lower_case_extension(file).substr(1) == name_of(kept);
}

}  // namespace

std::vector<NamedFile> without_twins(const std::vector<NamedFile>& files, Twins kept,
                                     std::vector<std::string>& notes) {
  std::map<std::string, std::vector<fs::path>> by_name;
  for (const NamedFile& file : files) by_name[file.name].push_back(file.path);
  std::vector<NamedFile> result;
  std::vector<std::string> refused;
  std::string hint;  // an extension that would tell some of them apart
  std::size_t left_out = 0;
  for (const NamedFile& file : files) {
    std::vector<fs::path>& same = by_name[file.name];
    if (same.empty()) continue;  // the name has been dealt with
    if (same.size() > 1) {
      const auto chosen = [&](const fs::path& path) { return is_kept(path, kept); };
      if (std::count_if(same.begin(), same.end(), chosen) == 1) {
        left_out += same.size() - 1;
        same = {*std::ranges::find_if(same, chosen)};
      } else {
        if (hint.empty()) hint = telling_extension(same);
        refused.push_back(file_names(same));
      }
    }
    result.push_back({file.name, same.front()});
    same.clear();
  }
  if (!refused.empty())
    throw InputError(fmt::format(
        "{}: several files of one name: {}; {}", files.front().path.parent_path().string(),
        fmt::join(refused, ", "),
        hint.empty()
            ? "an item has one file: rename or remove the others"
            : fmt::format("say which extension counts, such as dataset.twins: {}, or keep one of each",
                          hint)));
  if (left_out > 0)
    notes.push_back(
        fmt::format("files left out, as there is a .{} file of the same name: {}", name_of(kept), left_out));
  return result;
}

}  // namespace salbench
