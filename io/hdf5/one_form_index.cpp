// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/one_form_index.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "io/table.h"
#include "stages/core/errors.h"
#include "stages/core/number.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// True for file names without path components. A view's name is also a group's.
bool may_be_name(std::string_view word) {
  return !word.empty() && word != "." && word != ".." && word.find('/') == std::string_view::npos &&
         word.find('\0') == std::string_view::npos;
}

// Reads the columns of a row, and reports errors with their position.
struct IndexReader {
  Table table;
  std::size_t row = 0;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", table.name, table.lines[row], what));
  }
  std::string text(std::string_view column) const {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i] == column) return std::get<std::string>(table.rows[row][i]);
    throw InputError(
        fmt::format("{}: has no column '{}': expected the index of a set in the HDF5 form; there are {}",
                    table.name, column, fmt::join(table.columns, ", ")));
  }
  bool has(std::string_view column) const { return std::ranges::count(table.columns, column) > 0; }
  std::size_t count(std::string_view column) const {
    const std::string digits = text(column);
    if (const auto number = number_in<std::size_t>(digits)) return *number;
    fail(fmt::format("{} is {}, expected a whole number", column, in_quotes(digits)));
  }
  // True for the first word, false for the second.
  bool is(std::string_view column, std::string_view yes, std::string_view no) const {
    const std::string word = text(column);
    if (word != yes && word != no)
      fail(fmt::format("{} is {}, expected {} or {}", column, in_quotes(word), yes, no));
    return word == yes;
  }
  // Text that tables and pages show.
  std::string line(std::string_view column) const {
    const std::string words = text(column);
    if (const auto wrong = wrong_with_line(words); !wrong.empty())
      fail(fmt::format("{} {} has {}, which tables cannot have: rename it", column, in_quotes(words), wrong));
    return words;
  }
  // A file name.
  std::string name(std::string_view column) const {
    const std::string word = text(column);
    if (!may_be_name(word))
      fail(fmt::format("{} is {}, expected the name of a file without its extension", column,
                       in_quotes(word)));
    return word;
  }
};

std::vector<Item> items_of(const fs::path& root, Table table) {
  IndexReader in{std::move(table)};
  std::vector<Item> items;
  std::set<std::string> names;
  for (; in.row < in.table.rows.size(); ++in.row) {
    const std::string shape = in.name("item"), view = in.text("view").empty() ? "" : in.name("view");
    items.push_back({.name = view.empty() ? shape : shape + "_" + view,
                     .category = in.line("class"),
                     .split = in.line("split"),
                     .shape = view.empty() ? "" : shape,
                     .view = view,
                     .read_by = ReadBy::form,
                     .file = root / file_of_shape(shape),
                     .is_cloud = in.is("kind", "cloud", "mesh"),
                     .with_truth = in.is("truth", "yes", "no"),
                     .participants = in.count("participants"),
                     .viewers = in.count("viewers"),
                     .recorded = in.has("recorded") ? in.count("recorded") : 0});
    if (const std::string& name = items.back().name; !names.insert(name).second)
      in.fail(fmt::format("item {} is listed already: keep one of the lines", in_quotes(name)));
  }
  return items;
}

// Remark on the ground truth, repeated in every table: "TRUTH: ..."; empty if there is none. Limited to one
// line of text, since it enters tables.
std::string remark_of(const Table& table) {
  constexpr std::string_view kTruth = "TRUTH: ";
  constexpr std::size_t kLongest = 400;
  for (const std::string& line : table.remarks) {
    if (!line.starts_with(kTruth)) continue;
    if (line.size() > kLongest || std::ranges::any_of(line, [](unsigned char c) { return c < ' '; }))
      throw InputError(fmt::format("{}: the remark {} is no line of at most {} characters: shorten it",
                                   table.name, in_quotes(line), kLongest));
    return line;
  }
  return {};
}

}  // namespace

std::string file_of_shape(const std::string& shape) { return fmt::format("items/{}.h5", shape); }

Dataset indexed_dataset(const fs::path& root) {
  const fs::path file = root / kIndexFile;
  Table table = read_csv(file);
  Dataset dataset{.layout = std::string(kOneForm), .items = {}, .notes = {}, .splits_where = file};
  dataset.remark = remark_of(table);
  if (!dataset.remark.empty()) dataset.notes.push_back(dataset.remark);
  dataset.items = items_of(root, std::move(table));
  if (dataset.items.empty()) throw InputError(fmt::format("{}: lists no item", file.string()));
  return dataset;
}

}  // namespace salbench
