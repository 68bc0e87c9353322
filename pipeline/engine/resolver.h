// SPDX-License-Identifier: GPL-3.0-or-later
// Settles single jobs: loads what a job reads, calls its rule's function, stores the result. The one
// place where rules are computed, for a run, for a check of the cache and for an export.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cache/store.h"
#include "pipeline/engine/plan.h"

namespace salbench {

struct Failure {
  Job job;
  std::string cause;
  bool defect = false;  // of the program, or memory ran out: nothing is wrong with the unit
};

using Clock = std::chrono::steady_clock;

// Attribute of an artefact: seconds of all cores, where they are known.
inline constexpr const char* kProcessorSeconds = "processor_seconds";

// What a rule's function waits until it is its turn, before it begins, is no part of what the job takes.
void note_waiting(Clock::duration time);

// Statistics of one rule.
struct RuleRecord {
  std::size_t settled = 0;          // jobs that a run decided, computed or not
  std::vector<float> seconds = {};  // of each job that was computed
  double processor_seconds = 0;     // of all of them
};

class Resolver {
 public:
  // Treatment of an artefact that turns out to be damaged.
  enum class Damaged { restore, report };

  // Keeps references to the project and the store; the plan becomes its own and is updated as jobs are
  // settled.
  Resolver(const Project& project, Plan plan, Store& store, Damaged damaged = Damaged::restore);

  const Project& project() const { return project_; }
  const Plan& plan() const { return plan_; }
  Store& store() const { return store_; }

  // Brings an open job to its end: to known, not applicable or failed. It stays open if it is interrupted.
  // Its inputs have ended. Several threads may settle different jobs. Throws StorageError.
  void settle_job(const Job& job);

  // The result of a known job: in memory, from the cache, or given. A damaged artefact is computed again;
  // only the same content will do. With Damaged::report it is an InputError.
  ValuePtr value(const Job& job);

  // The same of a job that gathers, which may be open: then over the units that are known so far.
  ValuePtr value_so_far(const Job& job);

  // Computes a job again from what the cache has, and stores nothing.
  ValuePtr recompute(const Job& job);

  // Failures are said later: by say_messages, or as one of the stage.
  void hold_messages();
  void say_messages();
  // If the first jobs, so many, have all failed by themselves and in one way, but for the name of the unit:
  // says so once, and what is open of the others fails without being tried.
  void give_up_if_alike(const std::vector<Job>& jobs, std::size_t first);

  void forget(Unit unit);  // drops its values
  void forget_all();

  std::vector<Failure> failures() const;                               // by family and unit, then by rule
  const std::vector<RuleRecord>& records() const { return records_; }  // [rule]
  std::size_t computed() const;
  std::string at_work() const;  // "map.LS, 2 map.CS"

 private:
  class AtWork;
  struct Result {
    ValuePtr value;
    std::string remark;
    double seconds = 0, processor_seconds = 0;
  };
  ValuePtr held(const Job& job);
  ValuePtr hold(const Job& job, const ValuePtr& value);  // of two, the first
  ValuePtr restored(const Job& job);
  // Files are read where they are not given.
  Result result_of(const Job& job, std::vector<FileData> files = {});
  Digest save(const Job& job, const Result& result);
  void compute_and_save(const Job& job, std::vector<FileData> files);
  void record_failure(const Job& job, std::string cause, bool defect = false);

  const Project& project_;
  Plan plan_;
  Store& store_;
  Damaged damaged_;
  mutable std::mutex mutex_;        // of the containers below; held for moments only
  std::recursive_mutex restoring_;  // a damaged value may need other damaged ones
  std::map<std::pair<Unit, std::size_t>, ValuePtr>
      values_;  // (unit, rule): of families at work, and the root
  std::vector<Failure> failures_;
  bool holds_messages_ = false;
  std::map<Job, std::string> held_messages_;
  std::vector<RuleRecord> records_;
  std::vector<std::size_t> running_;  // [rule]: jobs being computed
  std::condition_variable ended_;     // one of them
};

}  // namespace salbench
