// Carries a plan out: computes what is missing, item by item, and stores it.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "cache/store.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"

namespace salbench {

struct Failure {
  ItemRef item;
  std::string stage;
  std::string cause;
};

struct StageTiming {
  std::size_t computed = 0;
  double seconds = 0;  // summed over threads
};

class Runner {
 public:
  // All references must outlive the runner; it brings `plan` up to date as it goes.
  Runner(const Context& context, Plan& plan, Store& store, Progress& progress, const std::atomic<bool>& stop);
  ~Runner();

  // Two passes: everything up to the unmatched maps, then, with the reference histograms known, the rest.
  // Returns early once `stop` is set. An item's failure is recorded and stops nothing else. Throws
  // StorageError.
  void run(int threads);

  // A known result, from the cache where it is there. Damaged artefacts are computed again.
  Value result(const ItemRef& item, std::size_t stage);

  const std::vector<Failure>& failures() const { return failures_; }  // by item, then in the order of stages
  const std::map<std::string, StageTiming>& timings() const { return timings_; }
  std::size_t computed() const;

 private:
  class FamilyRun;
  void run_pass(int threads, bool after_reference);
  void make_reference(bool meshes);
  void record(const ItemRef& item, const Stage& stage, const std::string& cause);
  void record(const std::string& stage, double seconds);

  const Context& context_;
  Plan& plan_;
  Store& store_;
  Progress& progress_;
  const std::atomic<bool>& stop_;
  std::mutex mutex_;  // of failures_ and timings_
  std::vector<Failure> failures_;
  std::map<std::string, StageTiming> timings_;
  std::array<std::shared_ptr<const Value>, 2> references_;  // of the meshes, of the scans
};

}  // namespace salbench
