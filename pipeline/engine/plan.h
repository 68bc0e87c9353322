// SPDX-License-Identifier: GPL-3.0-or-later
// Decides, without computing anything, what there is to do: rules x units x what the cache has -> decisions.
// Keys are made of the content digests of what a rule reads. Where an input still has to be computed, the key
// is not known yet: such a job waits, and may yet turn out to be in the cache when the input comes out as
// before.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cache/store.h"
#include "pipeline/engine/rule.h"

namespace salbench {

// All that is fixed before the first job.
struct Project {
  Rules rules;
  Units units;
  std::uint64_t seed = 0;
  Attributes attributes = {};  // written to every artefact
  bool is_share = false;       // other processes have the other units: nothing gathers a share

  const Rule& rule(const Job& job) const { return rules[job.rule]; }
  std::string name(const Job& job) const;    // of its unit; "scans" where it gathers them
  std::string family(const Job& job) const;  // where its result is stored; empty: of no family

  std::vector<Unit> units_of(std::size_t rule) const {
    return rules[rule].for_all ? units.all_of(rules[rule].level()) : units.of(rules[rule].level());
  }
  std::vector<Job> jobs_of(Unit unit) const;  // in the order of the rules
  std::vector<Job> jobs_of_rule(std::size_t rule) const;
  std::vector<Job> jobs() const;  // of each rule for all units
  // The job whose result a job reads through one of its inputs, unless it gathers; those of all units then.
  Job input_job(const Job& job, std::size_t input) const;
  std::vector<Job> input_jobs(const Job& job, std::size_t input) const;
  std::span<File> files(const Job& job) const;  // none where it reads none

  // The rules given and all that they read, directly or not: [rule].
  std::vector<bool> ancestors(const std::vector<std::size_t>& rules_given) const;
};

enum class State : std::uint8_t {
  open,            // to be computed, once its inputs are known
  known,           // in the cache, computed by this run, or given
  not_applicable,  // there is nothing to be computed of this unit
  failed,          // this rule, or something that it reads
};

// Of the state. What a run has computed keeps the one it had before.
enum class Reason : std::uint8_t {
  none,            // found in the cache, or given
  never_computed,  // nothing in the cache for this rule and unit
  changed,         // the cache has this rule of the unit for other inputs, options, seed or version
  input_pending,   // waits for the blocking input
  input_failed,    // the blocking input failed
  no_files,        // the unit has no files of a kind that units have; or no unit that is gathered is known
  not_given,       // nothing was given for this unit
  unreadable,      // a file cannot be read
  damaged,         // the artefact is truncated or fails its checksum
  inapplicable,    // the rule has nothing to say of the unit
  only_cached,     // not in the cache, and not to be computed
  needs_all,       // gathers all units, of which these are a share
};

struct Decision {
  State state = State::open;
  Reason reason = Reason::none;
  std::uint8_t blocking_input = 0;  // index among the rule's inputs
  Digest key = {};                  // zero where an input is missing or unreadable
  Digest content = {};              // where known

  bool known() const { return state == State::known; }
  bool open() const { return state == State::open; }
  bool waits() const { return open() && reason == Reason::input_pending; }
  bool computed() const { return known() && reason != Reason::none; }  // by this run
};

struct Plan {
  std::vector<std::vector<Decision>> decisions;  // [rule][unit's index]; of no unit: not applicable

  Decision& operator[](const Job& job) { return decisions[job.rule][job.unit.index]; }
  const Decision& operator[](const Job& job) const { return decisions[job.rule][job.unit.index]; }
  std::size_t open(std::size_t rule) const;  // jobs to compute or waiting
};

// Everything the job's result is a function of, as far as its inputs are known.
Recipe recipe_of(const Project& project, const Plan& plan, const Job& job);

// The same under other names. That of a user's model is a label: its maps are found under the name that it
// had when they were computed. A variant finds those of its model.
std::vector<Recipe> renamed_recipes_of(const Project& project, const Plan& plan, const Job& job,
                                       const Index& index);

// Decides one job from the decisions on its inputs and what the cache has under its key.
Decision decide(const Project& project, const Plan& plan, const Job& job, const Index& index);

Plan make_plan(const Project& project, const Index& index);

// Decides the jobs of some units only, and what they read: all others are not applicable.
Plan make_plan_of(const Project& project, const Index& index, const std::vector<Job>& jobs);

}  // namespace salbench
