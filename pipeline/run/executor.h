// SPDX-License-Identifier: GPL-3.0-or-later
// Carries out single jobs: loads what a job reads, calls its row's function, stores the result. The one place
// where rows are run, for a run, for a check of the cache and for an export.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cache/store.h"
#include "pipeline/plan/plan.h"

namespace salbench {

struct Failure {
  JobRef job;
  std::string cause;
  bool defect = false;  // of the program, or memory ran out: nothing is wrong with the item
};

using Clock = std::chrono::steady_clock;

// Statistics of one row's node.
struct NodeRecord {
  std::size_t settled = 0;                      // jobs that passed through the node
  std::vector<float> seconds = {};              // of each job that was computed
  std::vector<Clock::time_point> started = {};  // of the same jobs
};

class Executor {
 public:
  // Treatment of an artefact that turns out to be damaged.
  enum class Damaged { restore, report };

  // Keeps references to its arguments, and updates `plan` as jobs finish.
  Executor(const Context& context, Plan& plan, Store& store, Damaged damaged = Damaged::restore);

  // Brings an open job to its end: from wait or compute to done, cached, not applicable, failed or blocked.
  // Its inputs are settled. Several threads may settle different jobs. Throws StorageError.
  void settle(const JobRef& job);

  // The result of a known job: in memory, from the cache, or given. A damaged artefact is computed again;
  // only the same content will do. With Damaged::report it is an InputError.
  ValuePtr load(const JobRef& job);

  // Computes a job again from what the cache has, and stores nothing: a known one, or one of the data set
  // over the members that are known so far.
  Value recompute(const JobRef& job);

  // Drops the values of an item; with a mesh or cloud, what was prepared for the jobs of its family.
  void forget(const Item& item);

  const std::vector<Failure>& failures() const { return failures_; }   // in no order
  const std::vector<NodeRecord>& records() const { return records_; }  // [row]
  std::string at_work() const;                                         // "map.LS, 2 map.CS"

 private:
  struct Result {
    Value value;
    std::string remark;
    Clock::time_point started;
    double seconds = 0;
  };
  ValuePtr held(const JobRef& job);
  void hold(const JobRef& job, ValuePtr value);
  ValuePtr input(const JobRef& job);
  ValuePtr restored(const JobRef& job);
  std::shared_ptr<Preparation> preparation(const JobRef& job);
  Result run(const JobRef& job, std::vector<SourceData> files);
  Digest store(const JobRef& job, const Recipe& recipe, const Result& result);
  void compute(const JobRef& job, std::vector<SourceData> files);
  void fail(const JobRef& job, std::string cause, bool defect = false);

  const Context& context_;
  Plan& plan_;
  Store& store_;
  Damaged damaged_;
  mutable std::mutex mutex_;                   // of the containers below; held for moments only
  std::recursive_mutex restoring_;             // a damaged value may need other damaged ones
  std::vector<std::vector<ValuePtr>> values_;  // [row][item]: of families at work, and of sets
  // By row and family: of families at work.
  std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<Preparation>> preparations_;
  std::vector<Failure> failures_;
  std::vector<NodeRecord> records_;
  std::vector<std::atomic<int>> running_;  // [row]: jobs being computed
};

}  // namespace salbench
