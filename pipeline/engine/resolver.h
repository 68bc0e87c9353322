// SPDX-License-Identifier: GPL-3.0-or-later
// Runs single jobs: loads the inputs, calls the rule's function, stores the result. All computation goes
// through here, for runs, cache checks and exports.
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
  bool defect = false;  // fault of the program, or out of memory: the unit itself is fine
};

using Clock = std::chrono::steady_clock;

// Attribute of an artefact: seconds over all cores, where known.
inline constexpr const char* kProcessorSeconds = "processor_seconds";

// Excludes queueing time before the start of a rule's function from the job's measured duration.
void note_waiting(Clock::duration time);

// Statistics of one rule.
struct RuleRecord {
  std::size_t settled = 0;          // jobs that a run decided, computed or not
  std::vector<float> seconds = {};  // per computed job
  double processor_seconds = 0;     // total
};

class Resolver {
 public:
  // Treatment of an artefact that turns out to be damaged.
  enum class Damaged { restore, report };

  // Keeps references to the project and the store. Owns the plan and updates it as jobs finish.
  Resolver(const Project& project, Plan plan, Store& store, Damaged damaged = Damaged::restore);

  const Project& project() const { return project_; }
  const Plan& plan() const { return plan_; }
  Store& store() const { return store_; }

  // Runs an open job whose inputs have finished. It becomes known, not applicable or failed, or stays open if
  // interrupted. Thread-safe for different jobs. Throws StorageError.
  void settle_job(const Job& job);

  // Result of a known job: from memory, from the cache, or given. A damaged artefact is recomputed and must
  // have the same content. With Damaged::report it is an InputError instead.
  ValuePtr value(const Job& job);

  // Result of a gathering job that may be open: over the units known so far.
  ValuePtr value_so_far(const Job& job);

  // Recomputes a job from cached inputs, without storing the result.
  ValuePtr recompute(const Job& job);

  // Defers failure messages to say_messages, or to one message per stage.
  void hold_messages();
  void say_messages();
  // If the first `first` jobs have all failed by themselves and alike except for the unit's name, reports
  // that once and marks the remaining open jobs as failed without trying them.
  void give_up_if_alike(const std::vector<Job>& jobs, std::size_t first);

  void forget(Unit unit);  // drops its values
  void forget_all();

  std::vector<Failure> failures() const;                               // ordered by family and unit, then by
                                                                       // rule
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
  ValuePtr hold(const Job& job, const ValuePtr& value);  // inserts; if another thread was first, returns its
                                                         // value
  ValuePtr restored(const Job& job);
  // Reads the files that are not passed in.
  Result result_of(const Job& job, std::vector<FileData> files = {});
  Digest save(const Job& job, const Result& result);
  void compute_and_save(const Job& job, std::vector<FileData> files);
  void record_failure(const Job& job, std::string cause, bool defect = false);

  const Project& project_;
  Plan plan_;
  Store& store_;
  Damaged damaged_;
  mutable std::mutex mutex_;                                 // guards the containers below; held briefly
  std::recursive_mutex restoring_;                           // restoring a damaged value may restore others
  std::map<std::pair<Unit, std::size_t>, ValuePtr> values_;  // (unit, rule): families in flight, and the root
  std::vector<Failure> failures_;
  bool holds_messages_ = false;
  std::map<Job, std::string> held_messages_;
  std::vector<RuleRecord> records_;
  std::vector<std::size_t> running_;  // [rule]: running jobs
  std::condition_variable ended_;     // signalled when a running job ends
};

}  // namespace salbench
