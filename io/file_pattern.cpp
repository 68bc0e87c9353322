// SPDX-License-Identifier: GPL-3.0-or-later
// A pattern is matched name by name from the root, each name by backtracking over its few pieces.
#include "io/file_pattern.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "io/file.h"
#include "io/text_scanner.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

enum class Kind { text, any, item, number, part };

struct Placeholder {
  std::string_view text;
  Kind kind;
  std::string_view stands_for;  // in messages
};
constexpr std::array<Placeholder, 5> kPlaceholders = {{{"*", Kind::any, "*"},
                                                       {"{item}", Kind::item, "NAME"},
                                                       {"{participant}", Kind::number, "NUMBER"},
                                                       {"{view}", Kind::part, "VIEW"},
                                                       {"{viewer}", Kind::part, "VIEWER"}}};
constexpr std::size_t kMostPerName = 3;  // placeholders; matching tries all their lengths

struct Piece {
  Kind kind;
  std::string_view text;
};
using Pieces = std::vector<Piece>;  // of one name

Pieces pieces_of(std::string_view name) {
  Pieces pieces;
  while (!name.empty()) {
    const auto here = std::find_if(kPlaceholders.begin(), kPlaceholders.end(),
                                   [&](const Placeholder& p) { return name.starts_with(p.text); });
    if (here != kPlaceholders.end()) {
      pieces.push_back({here->kind, here->text});
      name.remove_prefix(here->text.size());
      continue;
    }
    const std::size_t end = std::min(name.find_first_of("*{", 1), name.size());
    pieces.push_back({Kind::text, name.substr(0, end)});
    name.remove_prefix(end);
  }
  return pieces;
}

std::vector<std::string_view> names_of(std::string_view path) {
  std::vector<std::string_view> names;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    names.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_literal(const Pieces& pieces) { return pieces.size() == 1 && pieces[0].kind == Kind::text; }

struct Captured {
  std::optional<std::string> item;
  std::string part;
};

class Matcher {
 public:
  Matcher(const Pieces& pieces, const IsItem& is_item) : pieces_(pieces), is_item_(is_item) {}

  bool fits(std::string_view name, Captured& captured) const { return from(0, name, captured); }

 private:
  bool from(std::size_t i, std::string_view rest, Captured& captured) const {
    if (i == pieces_.size()) return rest.empty();
    const Piece& piece = pieces_[i];
    const std::string_view known = piece.kind == Kind::text                    ? piece.text
                                   : piece.kind == Kind::item && captured.item ? *captured.item
                                                                               : std::string_view();
    if (!known.empty()) return rest.starts_with(known) && from(i + 1, rest.substr(known.size()), captured);
    for (std::size_t length = rest.size() + 1; length-- > (piece.kind == Kind::any ? 0U : 1U);) {
      const std::string_view taken = rest.substr(0, length);
      if (piece.kind == Kind::number && !is_digits(taken)) continue;
      if (piece.kind == Kind::item && !is_item_(taken)) continue;
      Captured trial = captured;
      if (piece.kind == Kind::item) trial.item = taken;
      if (piece.kind == Kind::number || piece.kind == Kind::part) trial.part = taken;
      if (!from(i + 1, rest.substr(length), trial)) continue;
      captured = std::move(trial);
      return true;
    }
    return false;
  }

  const Pieces& pieces_;
  const IsItem& is_item_;
};

// As an item where that is possible, else as anything.
bool fits(const Pieces& pieces, std::string_view name, const IsItem& is_item, Captured& captured) {
  static const IsItem anything = [](std::string_view) { return true; };
  return Matcher(pieces, is_item).fits(name, captured) || Matcher(pieces, anything).fits(name, captured);
}

struct OpenFolder {
  fs::path path;
  Captured captured;
};

// The folders that the files of a pattern may be in.
std::vector<OpenFolder> folders_like(const fs::path& root, std::string_view pattern, const IsItem& is_item) {
  std::vector<OpenFolder> folders = {{root, {}}};
  std::vector<std::string_view> names = names_of(pattern);
  names.pop_back();
  for (const std::string_view name : names) {
    const Pieces pieces = pieces_of(name);
    std::vector<OpenFolder> below;
    for (const OpenFolder& folder : folders) {
      if (is_literal(pieces)) {
        below.push_back({(folder.path / name).lexically_normal(), folder.captured});
        continue;
      }
      for (const FolderEntry& entry : list_folder(folder.path)) {
        OpenFolder next{entry.path, folder.captured};
        const std::string found = entry.path.filename();
        if (entry.is_folder && !found.starts_with('.') && fits(pieces, found, is_item, next.captured))
          below.push_back(std::move(next));
      }
    }
    folders = std::move(below);
  }
  return folders;
}

// The text after the last placeholder of a name; may be empty.
std::string_view ending(const Pieces& pieces) {
  return pieces.back().kind == Kind::text ? pieces.back().text : std::string_view();
}

std::string wrong_with(std::string_view text) {
  if (text.empty()) return "is empty";
  for (const std::string_view name : names_of(text)) {
    if (name.empty()) return "must be relative to the folder of the data set, without an empty name in it";
    const Pieces pieces = pieces_of(name);
    std::size_t placeholders = 0;
    for (const Piece& piece : pieces) {
      placeholders += piece.kind != Kind::text ? 1U : 0U;
      if (piece.kind == Kind::text && piece.text.find_first_of("{}") != std::string_view::npos)
        return "has braces around something other than item, participant, view or viewer";
    }
    if (placeholders > kMostPerName)
      return fmt::format("has more than {} placeholders in one name", kMostPerName);
  }
  return {};
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace

std::string wrong_with_mesh_pattern(std::string_view text) {
  if (contains(text, "{")) return "must have * where the names of meshes differ, and no braces";
  return wrong_with(text);
}

std::string wrong_with_truth_pattern(std::string_view text, const std::vector<std::string_view>& parts) {
  if (const std::string wrong = wrong_with(text); !wrong.empty()) return wrong;
  if (!contains(text, "{item}")) return "must have {item} in place of the name of the item";
  std::size_t found = 0;
  for (const Placeholder& p : kPlaceholders) {
    if (p.kind != Kind::number && p.kind != Kind::part) continue;
    const bool allowed = std::find(parts.begin(), parts.end(), p.text) != parts.end();
    if (contains(text, p.text) && !allowed) return fmt::format("cannot have {} here", p.text);
    found += contains(text, p.text) ? 1U : 0U;
  }
  return found > 1 ? "has both {view} and {viewer}" : "";
}

FoundFiles files_like(const fs::path& root, const FilePattern& pattern, const IsItem& is_item) {
  FoundFiles found;
  if (pattern.empty()) return found;
  const Pieces pieces = pieces_of(names_of(pattern.text).back());
  for (const OpenFolder& folder : folders_like(root, pattern.text, is_item)) {
    for (const FolderEntry& entry : list_folder(folder.path)) {
      const std::string name = entry.path.filename();
      if (entry.is_folder || name.starts_with('.')) continue;
      Captured captured = folder.captured;
      if (fits(pieces, name, is_item, captured))
        found.fit.push_back({entry.path, captured.item.value_or(""), captured.part});
      else if (!ending(pieces).empty() && name.ends_with(ending(pieces)))
        found.left_out.push_back(entry.path);
    }
  }
  std::sort(found.fit.begin(), found.fit.end(), [](const FoundFile& a, const FoundFile& b) {
    return natural_less(a.path.native(), b.path.native());
  });
  std::sort(found.left_out.begin(), found.left_out.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.native(), b.native()); });
  return found;
}

bool has_folder_for(const fs::path& root, const FilePattern& pattern) {
  if (pattern.empty()) return false;
  const auto folders = folders_like(root, pattern.text, [](std::string_view) { return false; });
  return std::any_of(folders.begin(), folders.end(),
                     [](const OpenFolder& folder) { return is_folder(folder.path); });
}

bool one_file_per_item(const FilePattern& pattern) {
  return std::none_of(kPlaceholders.begin(), kPlaceholders.end(), [&](const Placeholder& p) {
    return (p.kind == Kind::number || p.kind == Kind::part) && contains(pattern.text, p.text);
  });
}

bool has_viewers(const FilePattern& pattern) { return contains(pattern.text, "{viewer}"); }

bool has_views(const FilePattern& pattern) { return contains(pattern.text, "{view}"); }

std::string filled_in(const FilePattern& pattern, std::string_view item, std::string_view part) {
  std::string path;
  for (const std::string_view name : names_of(pattern.text)) {
    if (!path.empty()) path += '/';
    for (const Piece& piece : pieces_of(name))
      path += piece.kind == Kind::item ? item : piece.kind == Kind::part ? part : piece.text;
  }
  return path;
}

std::string expected_name(const FilePattern& pattern) {
  std::string name;
  for (const Piece& piece : pieces_of(names_of(pattern.text).back())) {
    const auto placeholder = std::find_if(kPlaceholders.begin(), kPlaceholders.end(),
                                          [&](const Placeholder& p) { return p.text == piece.text; });
    name += placeholder == kPlaceholders.end() ? piece.text : placeholder->stands_for;
  }
  return name;
}

std::string place_of(const fs::path& root, const FilePattern& pattern) {
  const fs::path path = (root / pattern.text).lexically_normal();
  return path.filename() == "*" ? path.parent_path().string() : path.string();
}

bool natural_less(std::string_view a, std::string_view b) {
  const auto digits_at = [](std::string_view text, std::size_t at) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
    return std::string_view(begin, std::find_if_not(begin, text.end(), is_digit));
  };
  const auto significant = [](std::string_view digits) {
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view run_a = digits_at(a, i), run_b = digits_at(b, j);
      const std::string_view x = significant(run_a), y = significant(run_b);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
      i += run_a.size();
      j += run_b.size();
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal but for leading zeros
}

}  // namespace salbench
