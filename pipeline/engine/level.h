// SPDX-License-Identifier: GPL-3.0-or-later
// Levels and units: what there is to work on, and the only arithmetic on indices. Levels are kinds of things:
// the root, which has one unit, the whole; heads of families below it; and their parts. A head is, with all
// its parts, a family: what is claimed, entered and held in memory at a time.
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

using Level = std::uint8_t;  // index of a LevelInfo; a subject has names for its own
inline constexpr Level kRoot = 0;

struct LevelInfo {
  std::string_view unit;        // one of them, for people: "scan"
  std::string_view units;       // all of them together: "scans"
  Level head = kRoot;           // of parts, before them; of a head and the root: the root
  std::uint32_t parts = 1;      // that each head has; of a head 1
  std::string_view place = {};  // name in keys of a part's number: "view"
};

struct Unit {
  Level level = kRoot;
  std::uint32_t index = 0;

  auto operator<=>(const Unit&) const = default;
};

struct Family {
  Level level;         // of its head
  std::string name;    // for people and in seeds
  std::any source;     // handed to rules; the engine never asks what it is
  bool chosen = true;  // false: it has only the jobs of rules that are `for_all`
};

class Units {
 public:
  Units() = default;
  Units(std::vector<LevelInfo> levels, std::vector<Family> families)
      : levels_(std::move(levels)),
        families_(std::make_shared<const std::vector<Family>>(std::move(families))) {}

  const std::vector<LevelInfo>& levels() const { return levels_; }
  const std::vector<Family>& families() const { return *families_; }

  // Indices of a level, of which only those belong to units whose families have the level.
  std::size_t slots(Level level) const {
    return level == kRoot ? 1 : families().size() * levels_[level].parts;
  }
  bool exists(Unit unit) const;
  std::size_t family_of(Unit unit) const {
    return unit.index / levels_[unit.level].parts;
  }  // not of the root
  const Family& source_of(Unit unit) const { return families()[family_of(unit)]; }
  std::uint32_t place(Unit unit) const { return unit.index % levels_[unit.level].parts; }
  Unit above(Unit unit, Level level) const;        // itself, its head, or the root
  bool is_above(Level above, Level level) const {  // or the same
    return above == kRoot || above == level || above == levels_[level].head;
  }

  // All in the order of the families. Of a level: those of the families that are chosen, or of all.
  std::vector<Unit> of(Level level) const { return of(level, false); }
  std::vector<Unit> all_of(Level level) const { return of(level, true); }
  bool is_chosen(Unit unit) const { return unit.level == kRoot || source_of(unit).chosen; }
  std::vector<Unit> below(Unit unit, Level level) const;
  std::vector<Unit> of_family(std::size_t family) const;  // each before those below it

  std::string name(Unit unit) const;  // "52", "52_3"

 private:
  std::vector<Unit> of(Level level, bool all) const;

  std::vector<LevelInfo> levels_;
  // One for all copies: sources are what a list of a million shapes takes.
  std::shared_ptr<const std::vector<Family>> families_ = std::make_shared<const std::vector<Family>>();
};

}  // namespace salbench
