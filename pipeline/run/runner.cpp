// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/runner.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>

#include <malloc.h>

#include "pipeline/run/graph.h"

namespace salbench {
namespace {

// Between two looks at whether another process has given up a claim: longer and longer, so that waiting costs
// nothing.
constexpr std::chrono::milliseconds kFirstPoll(20), kLongestPoll(500);
// The large arrays of a family leave holes that small, lasting ones pin: unless it is handed back, memory
// that is free grows with every family that has passed, to ten times what is in use.
constexpr std::size_t kFamiliesPerTrim = 16;

// The reference histograms, and all that they are made of.
std::vector<bool> reference_rows(const Catalog& catalog) {
  std::vector<std::size_t> references;
  for (const Row& row : catalog.rows)
    for (const std::size_t input : row.inputs)
      if (catalog.rows[input].gathers) references.push_back(input);
  return ancestors(catalog, references);
}

// Rows that read nothing of other items.
std::vector<bool> rows_without_reference(const Catalog& catalog) {
  std::vector<bool> without;
  for (const Row& row : catalog.rows)
    without.push_back(!row.gathers && std::all_of(row.inputs.begin(), row.inputs.end(),
                                                  [&](std::size_t input) { return without[input]; }));
  return without;
}

// By the shape's content: shapes of one name in two data sets are not the same work.
std::string work_of(const Context& context, std::size_t family) {
  const auto& digest = context.workload.families[family].shape_file.front().digest;
  return "family " + (digest ? digest->hex() : context.workload.families[family].source.name);
}

}  // namespace

Runner::Runner(const Context& context, Plan& plan, Store& store, Progress& progress,
               const std::atomic<bool>& stop)
    : context_(context),
      plan_(plan),
      store_(store),
      progress_(progress),
      stop_(stop),
      executor_(context, plan, store) {}

void Runner::prepare() {
  if (open_jobs(std::vector<bool>(context_.catalog.rows.size(), true)) > 0) store_.prepare();
}

void Runner::run(int threads) {
  const std::vector<bool> reference = reference_rows(context_.catalog);
  settle("reference", reference, threads, Claimed::left);
  // Where other processes hold what the reference is made of, there is still work that does without it.
  if (open_jobs(reference) > 0)
    settle("maps", rows_without_reference(context_.catalog), threads, Claimed::left);
  settle("reference", reference, threads, Claimed::awaited);
  settle("evaluation", std::vector<bool>(context_.catalog.rows.size(), true), threads, Claimed::awaited);
  store_.sync();
}

void Runner::run_rows(const std::string& what, const std::vector<bool>& rows, int threads) {
  settle(what, rows, threads, Claimed::awaited);
  store_.sync();
}

std::size_t Runner::open_jobs(const std::vector<bool>& rows) const {
  std::size_t open = 0;
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (rows[row]) open += count_open(plan_.jobs[row]);
  return open;
}

// Jobs that other processes have claimed are left to the end; by then most of them are found in the cache. No
// claim is held while waiting for others, so that two processes never wait for each other.
void Runner::settle(const std::string& what, const std::vector<bool>& rows, int threads, Claimed claimed) {
  std::size_t open = open_jobs(rows);
  if (open == 0 || stop_) return;
  store_.prepare();
  progress_.begin(what, open, [this] { return executor_.at_work(); });
  while (open > 0 && !stop_) {
    const std::vector<std::string> claimed_by_others = stream_once(rows, threads);
    const std::size_t before = std::exchange(open, open_jobs(rows));
    if (open < before || stop_) continue;
    if (claimed == Claimed::left) break;
    if (claimed_by_others.empty()) throw std::logic_error("jobs are left that nothing can settle");
    await_any(claimed_by_others);
  }
  progress_.end();
}

// Returns when one of them is free: others may be held for hours yet.
void Runner::await_any(const std::vector<std::string>& claimed) const {
  const auto is_claimed = [&](const std::string& work) { return store_.is_claimed(work); };
  for (auto pause = kFirstPoll; !stop_ && std::ranges::all_of(claimed, is_claimed);
       pause = std::min(2 * pause, kLongestPoll))
    std::this_thread::sleep_for(pause);
}

// Returns the families and sets that other processes have claimed.
std::vector<std::string> Runner::stream_once(const std::vector<bool>& rows, int threads) {
  std::vector<std::unique_ptr<Claim>> claims(context_.workload.families.size());
  std::vector<std::string> claimed_by_others;
  std::mutex refusing;
  const auto claim_of = [&](const std::string& work) {
    std::unique_ptr<Claim> claim = store_.claim(work);
    const std::scoped_lock lock(refusing);
    if (!claim) claimed_by_others.push_back(work);
    return claim;
  };
  // Only a mesh's values are read by other shapes: those of a scan can go with its last job.
  std::vector<std::atomic<std::size_t>> open_of_scan(claims.size() * kViews);
  const auto open = [&](const JobRef& job) {
    const bool is_open = rows[job.row] && plan_[job].open();
    if (is_open && job.item.scope() == Scope::scan) ++open_of_scan[job.item.index()];
    return is_open;
  };
  const auto settle = [&](const JobRef& job) {
    std::unique_ptr<Claim> claim;
    if (job.item.is_set()) {
      claim = claim_of(context_.row(job).name + " " + context_.name(job));
      if (!claim) return false;
    }
    executor_.settle(job);
    if (job.item.scope() == Scope::scan && --open_of_scan[job.item.index()] == 0) executor_.forget(job.item);
    progress_.item_done();
    return true;
  };
  const auto enter = [&](std::size_t family) {
    claims[family] = claim_of(work_of(context_, family));
    return claims[family] != nullptr;
  };
  std::atomic<std::size_t> left = 0;
  const auto leave = [&](std::size_t family) {
    for (const Item& item : family_items(context_, family)) executor_.forget(item);
    claims[family].reset();
    if (++left % kFamiliesPerTrim == 0) malloc_trim(0);
  };
  stream(context_, {.threads = threads, .families = threads + 1}, stop_, {open, enter, settle, leave});
  return claimed_by_others;
}

ValuePtr Runner::result_so_far(const JobRef& set) {
  return plan_[set].known() ? result(set) : std::make_shared<const Value>(executor_.recompute(set));
}

std::vector<Failure> Runner::failures() const {
  std::vector<Failure> failures = executor_.failures();
  std::stable_sort(failures.begin(), failures.end(), [](const Failure& a, const Failure& b) {
    return std::tuple(a.job.item.family, a.job.item.view, a.job.row) <
           std::tuple(b.job.item.family, b.job.item.view, b.job.row);
  });
  return failures;
}

std::size_t Runner::computed() const {
  std::size_t sum = 0;
  for (const NodeRecord& record : executor_.records()) sum += record.seconds.size();
  return sum;
}

}  // namespace salbench
