// SPDX-License-Identifier: GPL-3.0-or-later
// Carries a plan out: the reference first, then every item from its mesh file to its scores.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "pipeline/run/executor.h"
#include "pipeline/run/progress.h"

namespace salbench {

class Runner {
 public:
  // Keeps references to its arguments, and updates `plan` as jobs finish.
  Runner(const Context& context, Plan& plan, Store& store, Progress& progress, const std::atomic<bool>& stop);

  // Throws StorageError if there are jobs to do and their results could not be stored.
  void prepare();

  // Two streams through the graph: what the reference histograms are means of, then everything else. Returns
  // early once `stop` is set. An item's failure is recorded and stops nothing else. Throws StorageError.
  void run(int threads);

  // The jobs of the rows named, [row], and no others; rows that they read are among them. Otherwise as run.
  void run_rows(const std::string& what, const std::vector<bool>& rows, int threads);

  // A known result, from the cache where it is there. Damaged artefacts are computed again.
  ValuePtr result(const JobRef& job) { return executor_.load(job); }

  // The same for a job of the data set, which may be open: then over the members that are known so far.
  ValuePtr result_so_far(const JobRef& set);

  std::vector<Failure> failures() const;  // by item, then in the order of rows
  const std::vector<NodeRecord>& records() const { return executor_.records(); }  // [row]
  std::size_t computed() const;
  Progress& progress() const { return progress_; }

 private:
  // Treatment of jobs that other processes have claimed.
  enum class Claimed { left, awaited };
  void settle(const std::string& what, const std::vector<bool>& rows, int threads, Claimed claimed);
  std::size_t open_jobs(const std::vector<bool>& rows) const;
  std::vector<std::string> stream_once(const std::vector<bool>& rows, int threads);
  void await_any(const std::vector<std::string>& claimed) const;

  const Context& context_;
  Plan& plan_;
  Store& store_;
  Progress& progress_;
  const std::atomic<bool>& stop_;
  Executor executor_;
};

}  // namespace salbench
