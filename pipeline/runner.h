// Carries a plan out: computes what is missing, item by item, and stores it.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
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
  bool defect = false;  // of the program, or memory ran out: nothing is wrong with the item
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

  // Mean over the meshes or over the scans, after run(); nothing if there was nothing to average.
  std::optional<Histogram> mean(std::size_t index, bool meshes);

  // A known result, from the cache where it is there. Damaged artefacts are computed again.
  Value result(const ItemRef& item, std::size_t stage);

  const std::vector<Failure>& failures() const { return failures_; }  // by item, then in the order of stages
  const std::map<std::string, StageTiming>& timings() const { return timings_; }
  std::size_t computed() const;
  Progress& progress() const { return progress_; }

 private:
  class FamilyRun;
  using Work = std::vector<std::vector<ItemRef>>;  // by family: the items with something to do
  Work open_work(bool after_reference) const;
  void run_pass(int threads, bool after_reference);
  Work work_through(const Work& work, int threads, bool after_reference);  // returns what others have claimed
  std::unique_ptr<Claim> claim_of(std::size_t family) const;
  std::unique_ptr<Claim> wait_for_claim(const std::string& work) const;
  std::shared_ptr<const Value> make_mean(std::size_t index, bool meshes);
  void record(Failure failure);
  void record(const std::string& stage, double seconds);

  const Context& context_;
  Plan& plan_;
  Store& store_;
  Progress& progress_;
  const std::atomic<bool>& stop_;
  std::mutex mutex_;  // of failures_ and timings_
  std::vector<Failure> failures_;
  std::map<std::string, StageTiming> timings_;
  std::vector<std::array<std::shared_ptr<const Value>, 2>> means_;  // as Plan::means
};

}  // namespace salbench
