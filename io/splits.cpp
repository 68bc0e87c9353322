// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/splits.h"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "io/file.h"
#include "io/table.h"
#include "io/text_scanner.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

std::vector<SplitEntry> entries_of_table(const fs::path& file, const DataSplits& splits) {
  const Table table = read_csv(file);
  const std::vector<std::string> items = text_column(table, splits.item),
                                 names = text_column(table, splits.split);
  std::vector<SplitEntry> entries;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!names[i].empty())
      entries.push_back({items[i], names[i], fmt::format("{}:{}", file.string(), table.lines[i])});
  return entries;
}

// "data\rgb/Apple_v01.obj, maps/Apple_v01.csv" -> "Apple_v01.obj"
std::string last_name(std::string_view line) {
  line = line.substr(0, line.find_first_of(",;\t"));
  constexpr std::string_view kAround = " \"\r";
  line.remove_prefix(std::min(line.find_first_not_of(kAround), line.size()));
  line = line.substr(0, line.find_last_not_of(kAround) + 1);
  return std::string(line.substr(line.find_last_of("/\\") + 1));
}

std::vector<SplitEntry> entries_of_list(const fs::path& file, const DataSplits& splits,
                                        const IsItem& is_item) {
  const std::string text = read_file(file);
  TextScanner in(text, file.string());
  std::vector<SplitEntry> entries;
  for (std::size_t line = 1; in.next_line(); ++line) {
    const std::string name = last_name(in.line());
    if (name.empty()) continue;
    entries.push_back({is_item(name) ? name : fs::path(name).stem().string(), "",
                       fmt::format("{}:{}", file.string(), line)});
  }
  // As int(n * share) has it; rounding of the sum must not lose a line.
  constexpr double kRounding = 1e-9;
  double sum = 0;
  std::size_t first = 0;
  for (const auto& [name, share] : splits.shares) {
    sum += share;
    const auto last = static_cast<std::size_t>(
        std::floor(std::min(1.0, sum) * static_cast<double>(entries.size()) + kRounding));
    for (; first < last; ++first) entries[first].split = name;
  }
  return entries;
}

std::vector<SplitEntry> entries_named(const DataSplits& splits) {
  std::vector<SplitEntry> entries;
  for (const NamedSplit& split : splits.named)
    for (const std::string& item : split.items) entries.push_back({item, split.name, split.where});
  return entries;
}

}  // namespace

FoundSplits read_splits(const fs::path& root, const DataSplits& splits, const IsItem& is_item) {
  FoundSplits found;
  const fs::path file = (root / (splits.table.empty() ? splits.list : splits.table)).lexically_normal();
  if (splits.named.empty() && !size_of_file(file)) {
    found.missing = fmt::format("{}: is missing ({})", file.string(), splits.where);
    return found;
  }
  const std::vector<SplitEntry> entries = !splits.named.empty()   ? entries_named(splits)
                                          : !splits.table.empty() ? entries_of_table(file, splits)
                                                                  : entries_of_list(file, splits, is_item);
  std::map<std::string_view, const SplitEntry*> first;
  for (const SplitEntry& entry : entries) {
    if (!is_item(entry.item)) {
      found.unknown.push_back(entry);
      continue;
    }
    const auto [known, is_new] = first.emplace(entry.item, &entry);
    if (is_new) {
      found.of_item.emplace(entry.item, entry.split);
    } else if (known->second->split != entry.split) {
      found.of_item.erase(entry.item);
      found.problems.emplace(
          entry.item,
          fmt::format("{}: '{}' is in the split '{}', and by {} in '{}': keep one of them", entry.where,
                      entry.item, entry.split, known->second->where, known->second->split));
    }
  }
  return found;
}

std::string text_of_unknown(const std::vector<SplitEntry>& unknown) {
  std::set<std::string_view> names;
  for (const SplitEntry& entry : unknown) names.insert(entry.item);
  const SplitEntry& first = unknown.front();
  return fmt::format(
      "{}: the split '{}' names '{}', which is no item of the data set{}: correct the name, or "
      "add its files",
      first.where, first.split, first.item,
      names.size() == 1 ? "" : fmt::format(" ({} such names)", names.size()));
}

}  // namespace salbench
