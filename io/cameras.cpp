// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cameras.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "io/mesh_parts.h"
#include "io/table.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

std::vector<std::string> texts_if_there(const Table& table, std::string_view column) {
  return std::ranges::count(table.columns, column) > 0 ? text_column(table, column)
                                                       : std::vector<std::string>(table.rows.size());
}

}  // namespace

std::string_view wrong_with_camera(const Vec3& place, bool at_infinity) {
  if (at_infinity && place.isZero(0)) return "a direction has a length";
  return wrong_with_point(place);
}

FoundCameras::FoundCameras(const std::filesystem::path& root, const Cameras& cameras) {
  for (const auto& [view, place] : cameras.by_view)
    cameras_[{"", view}] = {{place, cameras.at_infinity}, cameras.where};
  if (cameras.file.empty()) return;
  const Table table = read_csv((root / cameras.file).lexically_normal());
  if (std::ranges::count(table.columns, "item") + std::ranges::count(table.columns, "view") == 0)
    throw InputError(
        fmt::format("{}:1: has neither a column 'item' nor 'view' ({})", table.name, cameras.where));
  const std::vector<double> x = number_column(table, "x"), y = number_column(table, "y"),
                            z = number_column(table, "z");
  const std::vector<std::string> items = texts_if_there(table, "item"), views = texts_if_there(table, "view");
  for (std::size_t row = 0; row < x.size(); ++row) {
    const std::string where = fmt::format("{}:{}", table.name, table.lines[row]);
    const Vec3 place(x[row], y[row], z[row]);
    if (const std::string_view wrong = wrong_with_camera(place, cameras.at_infinity); !wrong.empty())
      throw InputError(fmt::format("{}: {}", where, wrong));
    const auto [known, is_new] =
        cameras_.try_emplace({items[row], views[row]}, ItemCamera{{place, cameras.at_infinity}, where});
    if (!is_new)
      throw InputError(
          fmt::format("{}: {} has this camera already: keep one of them", where, known->second.where));
  }
}

const ItemCamera* FoundCameras::find(const std::string& item, const std::string& view) const {
  for (const std::pair<std::string, std::string>& key :
       {std::pair(item, view), std::pair(item, std::string()), std::pair(std::string(), view),
        std::pair(std::string(), std::string())})
    if (const auto found = cameras_.find(key); found != cameras_.end()) return &found->second;
  return nullptr;
}

}  // namespace salbench
