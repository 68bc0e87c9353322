// SPDX-License-Identifier: GPL-3.0-or-later
// Decides, without computing anything, which jobs to run: rules x units x cache content -> decisions. Keys
// contain the content digests of the inputs. A job whose input is still open has no key yet: it waits, and
// may turn out to be cached once the input has the same content as before.
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

// Everything that is fixed before the first job.
struct Project {
  Rules rules;
  Units units;
  std::uint64_t seed = 0;
  Attributes attributes = {};  // written to every artefact
  bool is_share = false;       // the units are a share, others belong to other processes: no rule gathers

  const Rule& rule(const Job& job) const { return rules[job.rule]; }
  std::string name(const Job& job) const;    // name of the job's unit; the level ("scans") if it gathers
  std::string family(const Job& job) const;  // family under which the result is stored; empty: none

  std::vector<Unit> units_of(std::size_t rule) const {
    return rules[rule].for_all ? units.all_of(rules[rule].level()) : units.of(rules[rule].level());
  }
  std::vector<Job> jobs_of(Unit unit) const;  // in the order of the rules
  std::vector<Job> jobs_of_rule(std::size_t rule) const;
  std::vector<Job> jobs() const;  // all rules, all units
  // Job whose result is read through an input. For a gathering job: one of all units.
  Job input_job(const Job& job, std::size_t input) const;
  std::vector<Job> input_jobs(const Job& job, std::size_t input) const;
  std::span<File> files(const Job& job) const;  // empty if it reads none

  // The given rules and all that they read, directly or indirectly: [rule].
  std::vector<bool> ancestors(const std::vector<std::size_t>& rules_given) const;
};

enum class State : std::uint8_t {
  open,            // to compute once its inputs are known
  known,           // cached, computed by this run, or given
  not_applicable,  // nothing to compute for this unit
  failed,          // this rule or one of its inputs failed
};

// Why a job has its state. Computed jobs keep their original reason.
enum class Reason : std::uint8_t {
  none,            // found in the cache, or given
  never_computed,  // no artefact of this rule and unit
  changed,         // the artefact has other inputs, options, seed or version
  input_pending,   // waits for the blocking input
  input_failed,    // the blocking input failed
  no_files,        // the unit lacks files that are expected, or no gathered unit is known
  not_given,       // no input given for this unit
  unreadable,      // a file cannot be read
  damaged,         // the artefact is truncated or fails its checksum
  inapplicable,    // the rule does not apply to the unit
  only_cached,     // not in the cache, and computing is excluded
  needs_all,       // gathers all units, but the run has only a share
};

struct Decision {
  State state = State::open;
  Reason reason = Reason::none;
  std::uint8_t blocking_input = 0;  // index among the rule's inputs
  Digest key = {};                  // zero while an input is missing or unreadable
  Digest content = {};              // zero unless known

  bool known() const { return state == State::known; }
  bool open() const { return state == State::open; }
  bool waits() const { return open() && reason == Reason::input_pending; }
  bool computed() const { return known() && reason != Reason::none; }  // computed by this run
};

struct Plan {
  std::vector<std::vector<Decision>> decisions;  // [rule][unit's index]; not applicable for indices without a
                                                 // unit

  Decision& operator[](const Job& job) { return decisions[job.rule][job.unit.index]; }
  const Decision& operator[](const Job& job) const { return decisions[job.rule][job.unit.index]; }
  std::size_t open(std::size_t rule) const;  // jobs to compute or waiting
};

// Everything that determines the job's result, as far as its inputs are known.
Recipe recipe_of(const Project& project, const Plan& plan, const Job& job);

// The same recipe under alternative names. The name of a user's model is only a label: maps are also found
// under the name that it had when they were computed. A variant finds those of its model.
std::vector<Recipe> renamed_recipes_of(const Project& project, const Plan& plan, const Job& job,
                                       const Index& index);

// Decides one job from the decisions on its inputs and the cache content under its key.
Decision decide(const Project& project, const Plan& plan, const Job& job, const Index& index);

Plan make_plan(const Project& project, const Index& index);

// Decides only the jobs of some units and the jobs that they read; all others are not applicable.
Plan make_plan_of(const Project& project, const Index& index, const std::vector<Job>& jobs);

}  // namespace salbench
