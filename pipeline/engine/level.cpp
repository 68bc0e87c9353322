// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/level.h"

#include <utility>

#include <fmt/format.h>

namespace salbench {

Units::Units(std::vector<LevelInfo> levels, std::vector<Family> families)
    : levels_(std::move(levels)),
      families_(std::make_shared<const std::vector<Family>>(std::move(families))) {
  for (const LevelInfo& level : levels_)
    width_.push_back(width_.empty() ? 1 : width_[level.parent] * level.parts);
}

bool Units::is_above(Level ancestor, Level level) const {
  while (level != ancestor && level != kRoot) level = levels_[level].parent;
  return level == ancestor;
}

bool Units::exists(Unit unit) const {
  return unit.level == kRoot || is_above(source_of(unit).level, unit.level);
}

Unit Units::above(Unit unit, Level level) const {
  if (level == kRoot) return {};
  return {level, unit.index / (width_[unit.level] / width_[level])};
}

std::vector<Unit> Units::of(Level level, bool all) const {
  std::vector<Unit> units;
  for (Unit unit{level, 0}; unit.index < slots(level); ++unit.index)
    if (exists(unit) && (all || is_chosen(unit))) units.push_back(unit);
  return units;
}

std::vector<Unit> Units::below(Unit unit, Level level) const {
  if (unit.level == kRoot) return all_of(level);
  const std::uint32_t each = width_[level] / width_[unit.level];
  std::vector<Unit> units;
  for (std::uint32_t i = 0; i < each; ++i) units.push_back({level, unit.index * each + i});
  return units;
}

std::vector<Unit> Units::of_family(std::size_t family) const {
  std::vector<Unit> units;
  const Level top = families()[family].level;
  for (Level level = top; level < levels_.size(); ++level)
    if (is_above(top, level))
      for (const Unit unit : below({top, static_cast<std::uint32_t>(family)}, level)) units.push_back(unit);
  return units;
}

std::string Units::name(Unit unit) const {
  const LevelInfo& info = levels_[unit.level];
  if (unit.level == kRoot || info.parent == kRoot)
    return unit.level == kRoot ? std::string(info.units) : families()[unit.index].name;
  return fmt::format("{}_{}", name(above(unit, info.parent)), place(unit));
}

}  // namespace salbench
