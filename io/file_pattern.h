// SPDX-License-Identifier: GPL-3.0-or-later
// Names of files as the description of a data set has them, such as "RawData/{item}_{participant}.pid".
//
//   *              any characters of one name
//   {item}         name of the item that the file belongs to
//   {participant}  digits
//   {view}, {viewer}  any characters of one name
//
// A name that begins with a dot is hidden and fits no pattern. Paths are relative, with '/' between names.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace salbench {

struct FilePattern {
  std::string text;        // empty: no such files
  std::string where = {};  // of the description, "schelling.yaml:7"

  bool empty() const { return text.empty(); }
};

// Describes what is wrong with a pattern; empty if it is valid. A mesh's has no placeholder but *. One of
// ground truth has {item}, and may have one of `parts`, such as "{participant}".
std::string wrong_with_mesh_pattern(std::string_view text);
std::string wrong_with_truth_pattern(std::string_view text, const std::vector<std::string_view>& parts);

struct FoundFile {
  std::filesystem::path path;
  std::string item;  // what {item} stands for; empty if the pattern has none
  std::string part;  // what {participant}, {view} or {viewer} stands for
};

struct FoundFiles {
  std::vector<FoundFile> fit;                   // in natural order of the paths
  std::vector<std::filesystem::path> left_out;  // end as the pattern does, but do not fit it
};

using IsItem = std::function<bool(std::string_view)>;

// Files below `root` that fit. {item} is an item wherever the name can be read so, the longest first, and any
// other text elsewhere. Lists folders and reads no file.
FoundFiles files_like(const std::filesystem::path& root, const FilePattern& pattern, const IsItem& is_item);

// True if a folder exists that a file of this pattern could be in.
bool has_folder_for(const std::filesystem::path& root, const FilePattern& pattern);

bool one_file_per_item(const FilePattern& pattern);  // neither {participant} nor {view} nor {viewer}
bool has_viewers(const FilePattern& pattern);        // {viewer}
bool has_views(const FilePattern& pattern);          // {view}

// The pattern with these in place of {item} and of {view} or {viewer}.
std::string filled_in(const FilePattern& pattern, std::string_view item, std::string_view part);

// "NAME_NUMBER.pid" for "RawData/{item}_{participant}.pid".
std::string expected_name(const FilePattern& pattern);

// The pattern below `root`, as a user reads it: its folder if every file in that is wanted.
std::string place_of(const std::filesystem::path& root, const FilePattern& pattern);

// A strict total order that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10".
bool natural_less(std::string_view a, std::string_view b);

}  // namespace salbench
