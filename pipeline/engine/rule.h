// SPDX-License-Identifier: GPL-3.0-or-later
// A rule computes one output of a level from its inputs; a job is a rule applied to one unit. The engine does
// not know the meaning of values and roles; binding.h makes rules from functions.
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
  std::vector<ValuePtr> values = {};  // results of the input rules, in their order
  std::size_t members = 0;            // gathering rules: number of units with a known value
  std::function<ValuePtr(std::size_t)> member = {};
  std::vector<FileData> files = {};
  std::string text = {};
  const std::any* source = nullptr;  // source of the family
  RandomSource random = {};          // from the seed and the unit's name
  std::uint32_t place = 0;
  std::string* remark = nullptr;  // set if the rule may write one
  // Value shared by the rule's jobs within a family: made by the first, dropped with the family's values.
  std::function<ValuePtr(const std::function<ValuePtr()>& make)> once = [](const auto& make) {
    return make();
  };
};

// Named text per unit that enters the key: a file's content, or what else distinguishes units.
struct KeyText {
  std::string name = {};
  std::function<std::optional<std::string>(Unit unit)> of = {};  // nullopt: none

  std::optional<std::string> in(Unit unit) const { return of ? of(unit) : std::nullopt; }
};

// Options as text, one `key: value` per line, with the path of their section in a configuration.
struct OptionLines {
  std::string section;  // "fpfh", "models.PS"
  std::string text;     // all options
  std::string in_key;   // options that enter the key
};

// Identity of a rule, and when its jobs run.
struct RuleHead {
  int role = 0;              // kind of output; an enum of the application, opaque to the engine
  std::string subject = {};  // distinguishes outputs of one role: the name of a model
  std::string stage = {};    // cache folder; shared by levels whose work is the same
  std::int32_t version = 1;  // raised when the output changes
  std::string same_as = {};  // other stage whose artefact with the same recipe may be reused
  std::function<bool(const std::any& source)> applies = {};  // families with this rule; empty: all
  std::size_t limit = 0;        // maximum of concurrent jobs, over the rules of a stage; 0: no limit
  bool only_if_cached = false;  // never computed; used if cached
  bool is_foreign = false;      // computed by a program or function of the user
};

// Everything that a job reads, and that therefore enters its key.
struct RuleInputs {
  std::vector<std::size_t> inputs = {};  // rules, each before this one
  std::vector<OptionLines> options = {};
  FilesOfUnits files = {};
  bool files_expected = true;  // expected of every unit; false: units without files are left out
  KeyText text = {};
  bool seeded = false;   // draws random numbers: seed and unit name enter the key
  bool placed = false;   // the unit's place enters the key
  bool gathers = false;  // one job of the root over all units of the rule's level
};

// Functions that compute a result, and convert it to an artefact and back.
struct RuleFunctions {
  std::function<ValuePtr(const JobInputs&)> compute = {};
  ValuePtr given = {};         // result known before the run; not stored
  bool remarks = false;        // may write a remark, stored with the result
  std::string_view kind = {};  // layout of the result in its artefact, and both conversions
  std::function<Arrays(const std::any&)> arrays = {};
  std::function<ValuePtr(const Arrays&)> read = {};  // throws InputError
};

struct Rule : RuleHead, RuleInputs, RuleFunctions {
  Level over = kRoot;    // level that the output describes
  bool for_all = false;  // also runs on families that are not chosen, because a gathering rule reads them

  Level level() const { return gathers ? kRoot : over; }  // level of its jobs
};
using Rules = std::vector<Rule>;

struct Job {
  std::size_t rule = 0;
  Unit unit;

  auto operator<=>(const Job&) const = default;
};

}  // namespace salbench
