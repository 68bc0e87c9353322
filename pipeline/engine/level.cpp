// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/level.h"

#include <fmt/format.h>

namespace salbench {

bool Units::exists(Unit unit) const {
  return unit.level == kRoot || is_above(source_of(unit).level, unit.level);
}

Unit Units::above(Unit unit, Level level) const {
  if (level == kRoot) return {};
  return {level, unit.index / (levels_[unit.level].parts / levels_[level].parts)};
}

std::vector<Unit> Units::of(Level level, bool all) const {
  std::vector<Unit> units;
  for (Unit unit{level, 0}; unit.index < slots(level); ++unit.index)
    if (exists(unit) && (all || is_chosen(unit))) units.push_back(unit);
  return units;
}

std::vector<Unit> Units::below(Unit unit, Level level) const {
  if (unit.level == kRoot) return all_of(level);
  const std::uint32_t each = levels_[level].parts / levels_[unit.level].parts;
  std::vector<Unit> units;
  for (std::uint32_t i = 0; i < each; ++i) units.push_back({level, unit.index * each + i});
  return units;
}

std::vector<Unit> Units::of_family(std::size_t family) const {
  std::vector<Unit> units;
  const Level top = families()[family].level;
  for (Level level = top; std::size_t{level} < levels_.size(); ++level)
    if (is_above(top, level))
      for (const Unit unit : below({top, static_cast<std::uint32_t>(family)}, level)) units.push_back(unit);
  return units;
}

std::string Units::name(Unit unit) const {
  if (unit.level == kRoot) return std::string(levels_[kRoot].units);
  const std::string& family = source_of(unit).name;
  return levels_[unit.level].head == kRoot ? family : fmt::format("{}_{}", family, place(unit));
}

}  // namespace salbench
