// SPDX-License-Identifier: GPL-3.0-or-later
// Levels and units of work, and all arithmetic on their indices. A level is a kind of thing: the root (one
// unit, the whole data set), family heads below it (a mesh), and their parts (its scans). A head with its
// parts is a family: families are claimed, entered and held in memory as a whole.
#pragma once

#include <any>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace salbench {

using Level = std::uint8_t;  // index of a LevelInfo; applications name their own levels
inline constexpr Level kRoot = 0;

struct LevelInfo {
  std::string_view unit;        // singular, in messages: "scan"
  std::string_view units;       // plural: "scans"
  Level head = kRoot;           // parent level of a part, which precedes it; kRoot for heads and the root
  std::uint32_t parts = 1;      // per head; 1 for a head
  std::string_view place = {};  // name of a part's number in keys: "view"
};

struct Unit {
  Level level = kRoot;
  std::uint32_t index = 0;

  auto operator<=>(const Unit&) const = default;
};

struct Family {
  Level level;         // level of its head
  std::string name;    // in messages and seeds
  std::any source;     // passed on to rules; opaque to the engine
  bool chosen = true;  // false: only rules with `for_all` run on it
};

class Units {
 public:
  Units() = default;
  Units(std::vector<LevelInfo> levels, std::vector<Family> families)
      : levels_(std::move(levels)),
        families_(std::make_shared<const std::vector<Family>>(std::move(families))) {}

  const std::vector<LevelInfo>& levels() const { return levels_; }
  const std::vector<Family>& families() const { return *families_; }

  // Index range of a level. Only indices of families that have the level are units.
  std::size_t slots(Level level) const {
    return level == kRoot ? 1 : families().size() * levels_[level].parts;
  }
  bool exists(Unit unit) const;
  std::size_t family_of(Unit unit) const {
    return unit.index / levels_[unit.level].parts;
  }  // undefined for the root
  const Family& source_of(Unit unit) const { return families()[family_of(unit)]; }
  std::uint32_t place(Unit unit) const { return unit.index % levels_[unit.level].parts; }
  Unit above(Unit unit, Level level) const;        // the unit itself, its head, or the root
  bool is_above(Level above, Level level) const {  // reflexive
    return above == kRoot || above == level || above == levels_[level].head;
  }

  // Units in the order of the families: of() of chosen families, all_of() of all.
  std::vector<Unit> of(Level level) const { return of(level, false); }
  std::vector<Unit> all_of(Level level) const { return of(level, true); }
  bool is_chosen(Unit unit) const { return unit.level == kRoot || source_of(unit).chosen; }
  std::vector<Unit> below(Unit unit, Level level) const;
  std::vector<Unit> of_family(std::size_t family) const;  // parents before children

  std::string name(Unit unit) const;  // "52", "52_3"

 private:
  std::vector<Unit> of(Level level, bool all) const;

  std::vector<LevelInfo> levels_;
  // Shared by all copies: a list of a million shapes is mostly their sources.
  std::shared_ptr<const std::vector<Family>> families_ = std::make_shared<const std::vector<Family>>();
};

}  // namespace salbench
