// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/map_counts.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "pipeline/rules/values.h"

namespace salbench {
namespace {

// When files were written: the maps of a family lie in one or two.
class WriteTimes {
 public:
  // Nothing: it has gone.
  std::optional<MapCount::Time> of(const std::filesystem::path& file) {
    const auto [known, is_new] = times_.try_emplace(file.native());
    std::error_code gone;
    const auto written =
        is_new ? std::filesystem::last_write_time(file, gone) : std::filesystem::file_time_type();
    if (is_new && !gone)
      known->second =
          std::chrono::time_point_cast<MapCount::Time::duration>(std::chrono::file_clock::to_sys(written));
    return known->second;
  }

 private:
  std::unordered_map<std::string, std::optional<MapCount::Time>> times_;
};

void add_read(MapCount& count, const std::optional<std::filesystem::path>& file, WriteTimes& times) {
  ++count.read;
  const auto time = file ? times.of(*file) : std::nullopt;
  if (!time) return;
  count.first = std::min(count.first, *time);
  count.last = std::max(count.last, *time);
}

std::string minute(MapCount::Time time) {
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

std::string span_text(const MapCount& count) {
  if (count.first > count.last) return "";
  const std::string first = minute(count.first), last = minute(count.last);
  return first == last ? first : fmt::format("{} to {}", first, last);
}

}  // namespace

std::vector<MapCount> count_maps(const Resolver& resolver, const FolderStore& store) {
  const Project& project = resolver.project();
  std::vector<MapCount> counts;
  WriteTimes times;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule) {
    if (!has_role(project.rules[rule], Role::map)) continue;
    const std::string& model = project.rules[rule].subject;
    auto count = std::ranges::find(counts, model, &MapCount::model);
    if (count == counts.end()) count = counts.insert(counts.end(), {.model = model});
    for (const Unit unit : project.units.of(project.rules[rule].over)) {
      const Decision& decision = resolver.plan()[{rule, unit}];
      if (!decision.known()) continue;
      if (decision.computed())
        ++count->computed;
      else
        add_read(*count, store.file_of(decision.key), times);
    }
  }
  return counts;
}

Table map_table(const std::vector<MapCount>& counts) {
  Table table{.columns = {"maps of", "computed now", "read", "from"}, .rows = {}};
  for (const MapCount& count : counts)
    table.rows.push_back({count.model, cell_of(count.computed), cell_of(count.read), span_text(count)});
  return table;
}

}  // namespace salbench
