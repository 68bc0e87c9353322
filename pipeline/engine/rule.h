// SPDX-License-Identifier: GPL-3.0-or-later
// A rule: how one output of a level is made, from what. A job is a rule for one unit. What a rule computes,
// and what its role means, only its subject knows; binding.h makes rules from functions.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/arrays.h"
#include "pipeline/engine/file.h"
#include "pipeline/engine/level.h"
#include "pipeline/engine/value.h"
#include "stages/core/rng.h"

namespace salbench {

// Arguments of a rule's function for one job.
struct JobInputs {
  std::vector<ValuePtr> values = {};  // of the rules that are read, in their order
  std::size_t members = 0;            // of a rule that gathers: units whose value is known
  std::function<ValuePtr(std::size_t)> member = {};
  std::vector<FileData> files = {};
  std::string text = {};
  const std::any* source = nullptr;  // of the family
  RandomSource random = {};          // the seed, and the unit's name
  std::uint32_t place = 0;
  std::string* remark = nullptr;  // set where a rule makes one
  // What the jobs of the rule share within a family, made by the first; it goes with the family's values.
  std::function<ValuePtr(const std::function<ValuePtr()>& make)> once = [](const auto& make) {
    return make();
  };
};

// A text of each unit that enters the key under a name: a file's, or what else tells units apart.
struct KeyText {
  std::string name = {};
  std::function<std::optional<std::string>(Unit unit)> of = {};  // nothing: there is none

  std::optional<std::string> in(Unit unit) const { return of ? of(unit) : std::nullopt; }
};

// Options as text, one `key: value` per line, with the path of their section in a configuration.
struct OptionLines {
  std::string section;  // "fpfh", "models.PS"
  std::string text;     // all options
  std::string in_key;   // those that enter the key
};

// Identity of a rule, and when its jobs run.
struct RuleHead {
  int role = 0;              // what its output is; the subject's enum, which the engine only hands back
  std::string subject = {};  // whose output, where several have one of this role: the name of a model
  std::string stage = {};    // folder in the cache; the same at all levels where the work is the same
  std::int32_t version = 1;  // raised when the output changes
  std::string same_as = {};  // another stage, whose result of the same recipe is taken where this has none
  std::function<bool(const std::any& source)> applies = {};  // to a family; empty: to every one
  std::size_t limit = 0;        // jobs at work at the same time, rules of one stage together; 0: no limit
  bool only_if_cached = false;  // taken from the cache where it is there, and never computed
  bool is_foreign = false;      // computed by a program or a function of the user
};

// Everything that a job reads, and so its key.
struct RuleInputs {
  std::vector<std::size_t> inputs = {};  // rules, each before this one
  std::vector<OptionLines> options = {};
  FilesOfUnits files = {};
  bool files_expected = true;  // of every unit; false: some units are left out
  KeyText text = {};
  bool seeded = false;   // draws random numbers: seed and unit enter the key
  bool placed = false;   // the unit's place enters the key
  bool gathers = false;  // one job of the root, over all units of the rule's level
};

// How a result is made, and how it becomes an artefact and back.
struct RuleFunctions {
  std::function<ValuePtr(const JobInputs&)> compute = {};
  ValuePtr given = {};         // in place of a result: known before the run, and not stored
  bool remarks = false;        // may make a remark, which is stored with the result
  std::string_view kind = {};  // layout of the result in its artefact, and the two ways
  std::function<Arrays(const std::any&)> arrays = {};
  std::function<ValuePtr(const Arrays&)> read = {};  // throws InputError
};

struct Rule : RuleHead, RuleInputs, RuleFunctions {
  Level over = kRoot;    // the level that the output is about
  bool for_all = false;  // has jobs of families that are not chosen, too: what is gathered needs them

  Level level() const { return gathers ? kRoot : over; }  // of its units
};
using Rules = std::vector<Rule>;

struct Job {
  std::size_t rule = 0;
  Unit unit;

  auto operator<=>(const Job&) const = default;
};

}  // namespace salbench
