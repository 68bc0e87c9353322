// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/data_layout.h"
#include "pipeline/inputs/inspection.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kMostNamed = 10;  // problems, and unused files

std::vector<std::string> first_of(const std::vector<std::string>& lines) {
  return {lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(std::min(lines.size(), kMostNamed))};
}

// How many items have each value of a field, in the order of their names; items without one do not count.
std::map<std::string, std::size_t> counts_of(const DataInspection& found, std::string ItemFacts::*field) {
  std::map<std::string, std::size_t> counts;
  for (const ItemFacts& item : found.items)
    if (!(item.*field).empty()) ++counts[item.*field];
  return counts;
}

std::string number_text(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

Json item_json(const ItemFacts& item) {
  return {{"name", item.name},
          {"shape", item.shape},
          {"view", item.view},
          {"split", item.split},
          {"class", item.category},
          {"kind", item.is_cloud ? "cloud" : "mesh"},
          {"points", item.points},
          {"faces", item.faces},
          {"diagonal", number_text(item.diagonal)},
          {"has_truth", item.has_truth},
          {"seen", item.seen},
          {"of_camera", item.of_camera},
          {"low", number_text(item.low)},
          {"high", number_text(item.high)},
          {"participants", item.participants},
          {"picks", item.picks},
          {"remark", item.remark},
          {"problem", item.problem}};
}

Json counts_json(const std::map<std::string, std::size_t>& counts) {
  return list_of(counts, [](const auto& count) {
    return Json{{"name", count.first}, {"items", count.second}};
  });
}

Json json_of(const DataInspection& found) {
  const std::vector<std::string> problems = found.problems();
  return {{"layout", found.layout},
          {"shapes", found.n_shapes()},
          {"positives", found.positives},
          {"scale", number_text(found.scale)},
          {"items", list_of(found.items, item_json)},
          {"splits", counts_json(counts_of(found, &ItemFacts::split))},
          {"views", counts_json(counts_of(found, &ItemFacts::view))},
          {"unused_files", found.unused.size()},
          {"unused", first_of(found.unused)},
          {"n_problems", problems.size()},
          {"problems", first_of(problems)}};
}

std::string counts_line(const char* topic, const std::map<std::string, std::size_t>& counts) {
  std::string line;
  for (const auto& [name, n] : counts) line += fmt::format("{}{} {}", line.empty() ? "" : ", ", name, n);
  return fmt::format("{:<8} {}\n", topic, line.empty() ? "none" : line);
}

std::string lines_text(const std::string& head, const std::vector<std::string>& lines) {
  std::string text = fmt::format("{}{}\n", head,
                                 lines.size() > kMostNamed ? fmt::format(", the first {}:", kMostNamed)
                                 : lines.empty()           ? ""
                                                           : ":");
  for (const std::string& line : first_of(lines)) text += fmt::format("  {}\n", line);
  return text;
}

// Lines on what few descriptions say.
std::string particulars(const DataInspection& found) {
  std::string text;
  const auto add = [&](const char* topic, const std::string& line) {
    text += fmt::format("{:<8} {}\n", topic, line);
  };
  if (found.positives != kPositivesArePicks) add("picks", found.positives);
  if (const auto n = std::ranges::count(found.items, true, &ItemFacts::of_camera); n > 0)
    add("seen", fmt::format("{} items as a camera sees them", n));
  if (found.scale != 1) add("scale", fmt::format("{}, of diagonals", found.scale));
  return text;
}

std::string text_of(const DataInspection& found) {
  std::string text = fmt::format("{:<8} {}\n{:<8} {} of {} shapes\n", "layout", found.layout, "items",
                                 found.items.size(), found.n_shapes());
  text += counts_line("splits", counts_of(found, &ItemFacts::split));
  text += counts_line("views", counts_of(found, &ItemFacts::view)) + particulars(found);
  Table table{.columns = {"item", "split", "points", "faces", "diagonal", "seen", "low", "high",
                          "participants", "picks"},
              .rows = {}};
  for (const ItemFacts& item : found.items) {
    const double share = item.points == 0 || !item.has_truth
                             ? std::numeric_limits<double>::quiet_NaN()
                             : static_cast<double>(item.seen) / static_cast<double>(item.points);
    table.rows.push_back({item.name, item.split, cell_of(item.points), cell_of(item.faces), item.diagonal,
                          share, item.low, item.high, cell_of(item.participants), cell_of(item.picks)});
  }
  text += "\n" + aligned(table) + "\n";
  text += lines_text(fmt::format("{} unused files", found.unused.size()), found.unused);
  const std::vector<std::string> problems = found.problems();
  return text + lines_text(fmt::format("{} problems", problems.size()), problems);
}

ExitStatus print_inspection(const Arguments& arguments, const std::string& layout, ReportFormat format) {
  require_layout("inspect", layout);
  if (arguments.data.empty()) throw ConfigError("inspect: names no data set: give --data DIR");
  const DataInspection found = inspect_data(arguments.data, layouts_of(layout));
  print_report(format, "inspect", json_of(found), text_of(found));
  return std::ranges::any_of(found.items, [](const ItemFacts& item) { return !item.problem.empty(); })
             ? kSomeFailed
             : kAllDone;
}

}  // namespace

Subcommand inspect_subcommand(Arguments& arguments) {
  const auto layout = std::make_shared<std::string>();
  const FormatWord format = default_format();
  return {
      "inspect",
      "read all files of a data set and print what its description finds: items, splits, ranges, problems",
      {layout_parameter(layout.get()), data_parameter(arguments), format_parameter(format)},
      [&arguments, layout, format](const std::atomic<bool>&) {
        return print_inspection(arguments, *layout, format_of(format));
      }};
}

}  // namespace salbench
