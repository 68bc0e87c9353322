// A family (a mesh and its scans) is the unit of memory: what its items read of each other is loaded once and
// dropped with the family. The flow graph sees three bodies: open, part, close.
#include "pipeline/runner.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/flow.h"
#include "stages/core/errors.h"
#include "stages/matching/matching.h"
#include "stages/scan/scan.h"

namespace salbench {
namespace {

using ValuePtr = std::shared_ptr<const Value>;

constexpr std::chrono::milliseconds kClaimPollInterval(50);  // whether another process has given up a claim

bool has_open_job(const Context& context, const Plan& plan, const ItemRef& item, bool after_reference) {
  const Chain& chain = context.chain(item);
  const auto& jobs = plan.jobs(item);
  for (std::size_t s = 0; s < chain.size(); ++s)
    if (chain[s].after_reference == after_reference && jobs[s].open()) return true;
  return false;
}

// Why a stage's source cannot be read.
std::string source_error(const Context& context, const ItemRef& item, const Stage& stage) {
  for (const SourceFile& file : sources_of(context, item, stage.source))
    if (!file.digest) return file.error;
  return {};
}

// Stages of the mesh that its scans read: they are settled before the scans start.
std::vector<std::size_t> shared_stages(const Catalog& catalog) {
  std::vector<std::size_t> shared;
  for (const Stage& stage : catalog.scan)
    for (const Input& input : stage.inputs)
      if (input.from == Input::From::mesh) shared.push_back(input.stage);
  std::sort(shared.begin(), shared.end());
  shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
  return shared;
}

}  // namespace

// The values of one family's items while it is worked on, each loaded or computed at most once.
class Runner::FamilyRun {
 public:
  FamilyRun(Runner& runner, std::size_t family) : runner_(runner), family_(family) {
    for (const ItemRef& item : runner.context_.family(family))
      values_.emplace_back(runner.context_.chain(item).size());
  }

  // Brings one job to its end: from wait or compute to done, cached, absent, failed or blocked.
  void advance(const ItemRef& item, std::size_t index) {
    Job& job = runner_.plan_.jobs(item)[index];
    if (!job.open()) return;
    const Stage& stage = runner_.context_.chain(item)[index];
    // The key is of what the files hold now: they may have been edited since they were planned with.
    std::vector<SourceData> files;
    if (stage.source != Source::none) files = read_again(sources_of(runner_.context_, item, stage.source));
    Decision decision = decide(
        runner_.context_, runner_.plan_, item, index,
        [&](std::string_view name, const Digest& key) { return runner_.store_.refresh_and_find(name, key); });
    // The plan's reason is kept: why it was recomputed is asked afterwards.
    const Reason reason = job.reason;
    job = decision.job;
    if (job.verdict != Verdict::compute) return;
    if (job.reason == Reason::unreadable) {
      fail(job, {item, stage.name, source_error(runner_.context_, item, stage)});
      return;
    }
    job.reason = reason;
    try {
      job.content = compute(item, index, decision.recipe, std::move(files));
      job.verdict = Verdict::done;
    } catch (const StorageError&) {
      throw;
    } catch (const InputError& error) {
      fail(job, {item, stage.name, error.what()});
    } catch (...) {
      fail(job, {item, stage.name, current_defect(), true});
    }
  }

  // The value of a known job. One thread at a time: items of the family share the mesh's values.
  ValuePtr value(const ItemRef& item, std::size_t index) {
    const std::lock_guard lock(mutex_);
    ValuePtr& slot = values_[static_cast<std::size_t>(item.view + 1)][index];
    if (slot) return slot;
    const Stage& stage = runner_.context_.chain(item)[index];
    Job& job = runner_.plan_.jobs(item)[index];
    if (const auto arrays = runner_.store_.load(stage.name, job.key)) {
      slot = std::make_shared<const Value>(value_from(stage.kind, *arrays));
    } else {
      job.reason = Reason::damaged;
      recompute(item, index, job.content);
    }
    return slot;
  }

 private:
  void fail(Job& job, Failure failure) {
    job.verdict = Verdict::failed;
    runner_.record(std::move(failure));
  }

  // A damaged artefact is a miss, but its content is still known: only the same content will do.
  void recompute(const ItemRef& item, std::size_t index, const Digest& expected) {
    Decision decision = decide(runner_.context_, runner_.plan_, item, index,
                               [](std::string_view, const Digest&) { return std::nullopt; });
    const Source source = runner_.context_.chain(item)[index].source;
    std::vector<SourceData> files;
    if (source != Source::none) files = read_unchanged(sources_of(runner_.context_, item, source));
    if (compute(item, index, decision.recipe, std::move(files)) != expected)
      throw std::logic_error(
          fmt::format("stage {} gave another result than before for the same inputs: it is not "
                      "deterministic; please report this",
                      runner_.context_.chain(item)[index].name));
  }

  Digest compute(const ItemRef& item, std::size_t index, const Recipe& recipe,
                 std::vector<SourceData> files) {
    const Stage& stage = runner_.context_.chain(item)[index];
    StageInputs inputs{.values = {},
                       .files = std::move(files),
                       .source = &runner_.context_.source(item),
                       .seed = runner_.context_.seed,
                       .item = runner_.context_.name(item),
                       .view = item.view};
    std::vector<ValuePtr> held;
    for (const Input& input : stage.inputs) {
      held.push_back(input_value(item, input));
      inputs.values.push_back(held.back().get());
    }
    const auto started = std::chrono::steady_clock::now();
    auto result = std::make_shared<const Value>(stage.run(inputs));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    ArtefactNote note{inputs.item, seconds, runner_.context_.attributes};
    const Digest content = runner_.store_.save(recipe, stage.kind, arrays_from(*result), note);
    runner_.record(stage.name, seconds);
    const std::lock_guard lock(mutex_);
    values_[static_cast<std::size_t>(item.view + 1)][index] = std::move(result);
    return content;
  }

  ValuePtr input_value(const ItemRef& item, const Input& input) {
    switch (input.from) {
      case Input::From::mesh:
        return value({family_, -1}, input.stage);
      case Input::From::reference:
        return runner_.means_[kReference][item.is_mesh() ? 0 : 1];
      default:
        return value(item, input.stage);
    }
  }

  Runner& runner_;
  std::size_t family_;
  std::recursive_mutex mutex_;                 // of values_; recomputing a damaged value needs further values
  std::vector<std::vector<ValuePtr>> values_;  // mesh, then the scans
};

Runner::Runner(const Context& context, Plan& plan, Store& store, Progress& progress,
               const std::atomic<bool>& stop)
    : context_(context), plan_(plan), store_(store), progress_(progress), stop_(stop) {}

Runner::~Runner() = default;

void Runner::run(int threads) {
  run_pass(threads, false);
  if (stop_) return;
  means_.resize(plan_.means.size());
  for (std::size_t index = 0; index < means_.size(); ++index)
    for (const bool meshes : {true, false}) {
      const auto claim = wait_for_claim(context_.catalog.means[index].name + (meshes ? " meshes" : " scans"));
      if (stop_) return;
      means_[index][meshes ? 0 : 1] = make_mean(index, meshes);
    }
  run_pass(threads, true);
  std::stable_sort(failures_.begin(), failures_.end(), [&](const Failure& a, const Failure& b) {
    if (a.item.family != b.item.family) return a.item.family < b.item.family;
    if (a.item.view != b.item.view) return a.item.view < b.item.view;
    const Chain& chain = context_.chain(a.item);
    return stage_index(chain, a.stage) < stage_index(chain, b.stage);
  });
}

Runner::Work Runner::open_work(bool after_reference) const {
  Work work;
  for (std::size_t f = 0; f < plan_.families.size(); ++f) {
    std::vector<ItemRef> open;
    for (const ItemRef& item : context_.family(f))
      if (has_open_job(context_, plan_, item, after_reference)) open.push_back(item);
    if (!open.empty()) work.push_back(std::move(open));
  }
  return work;
}

// Families claimed by other processes are left to the end; by then most are found in the cache. Nothing is
// held while waiting for them, so that two processes never wait for each other.
void Runner::run_pass(int threads, bool after_reference) {
  Work left = open_work(after_reference);
  if (left.empty()) return;
  std::size_t items = 0;
  for (const auto& family : left) items += family.size();
  progress_.begin(after_reference ? "matching and scoring" : "maps", items);
  while (!left.empty() && !stop_) {
    Work claimed_by_others = work_through(left, threads, after_reference);
    if (claimed_by_others.size() == left.size()) std::this_thread::sleep_for(kClaimPollInterval);
    left = std::move(claimed_by_others);
  }
  progress_.end();
}

Runner::Work Runner::work_through(const Work& work, int threads, bool after_reference) {
  struct Alive {
    std::unique_ptr<Claim> claim;
    std::unique_ptr<FamilyRun> family;
  };
  std::vector<Alive> alive(work.size());
  std::vector<char> claimed_by_others(work.size(), 0);
  const std::vector<std::size_t> shared = shared_stages(context_.catalog);
  const auto advance_item = [&](FamilyRun& family, const ItemRef& item) {
    const Chain& chain = context_.chain(item);
    for (std::size_t s = 0; s < chain.size() && !stop_; ++s)
      if (chain[s].after_reference == after_reference) family.advance(item, s);
  };
  const auto open = [&](int w) {
    const auto index = static_cast<std::size_t>(w);
    const std::size_t f = work[index].front().family;
    alive[index].claim = claim_of(f);
    claimed_by_others[index] = alive[index].claim == nullptr;
    if (claimed_by_others[index] != 0) return 0;
    alive[index].family = std::make_unique<FamilyRun>(*this, f);
    for (const std::size_t s : shared)
      if (!after_reference) alive[index].family->advance({f, -1}, s);
    return static_cast<int>(work[index].size());
  };
  const auto part = [&](int w, int p) {
    const auto index = static_cast<std::size_t>(w);
    advance_item(*alive[index].family, work[index][static_cast<std::size_t>(p)]);
    if (!stop_) progress_.item_done();
  };
  const auto close = [&](int w) { alive[static_cast<std::size_t>(w)] = {}; };
  stream_families(static_cast<int>(work.size()), {.threads = threads, .families_alive = threads + 1}, stop_,
                  {open, part, close});
  Work left;
  for (std::size_t w = 0; w < work.size(); ++w)
    if (claimed_by_others[w] != 0) left.push_back(work[w]);
  return left;
}

// By the mesh's content: meshes of one name in two data sets are not the same work.
std::unique_ptr<Claim> Runner::claim_of(std::size_t family) const {
  const auto& digest = context_.workload.families[family].mesh_file.front().digest;
  return store_.claim("family " + (digest ? digest->hex() : context_.name({family, -1})));
}

std::unique_ptr<Claim> Runner::wait_for_claim(const std::string& work) const {
  while (!stop_) {
    if (auto claim = store_.claim(work)) return claim;
    std::this_thread::sleep_for(kClaimPollInterval);
  }
  return nullptr;
}

// Serial and in the order of the items: sums of doubles depend on their order.
ValuePtr Runner::make_mean(std::size_t index, bool meshes) {
  if (index == kReference && context_.given_reference)
    return std::make_shared<const Value>(*context_.given_reference);
  const MeanHistogram& mean = context_.catalog.means[index];
  Job& job = plan_.means[index][meshes ? 0 : 1];
  Decision decision = decide_mean(
      context_, plan_, index, meshes,
      [&](std::string_view name, const Digest& key) { return store_.refresh_and_find(name, key); });
  job = decision.job;
  if (job.verdict == Verdict::cached)
    if (const auto arrays = store_.load(mean.name, job.key))
      return std::make_shared<const Value>(value_from("histogram", *arrays));
  if (job.verdict == Verdict::not_applicable) return {};

  const auto started = std::chrono::steady_clock::now();
  const std::size_t stage = meshes ? stage_index(context_.catalog.mesh, mean.of_mesh)
                                   : stage_index(context_.catalog.scan, mean.of_scan);
  std::vector<Histogram> histograms;
  for (const ItemRef& item : context_.items(meshes))
    if (plan_.jobs(item)[stage].known()) histograms.push_back(histogram_of(result(item, stage)));
  auto value = std::make_shared<const Value>(mean_histogram(histograms));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const ArtefactNote note{meshes ? "meshes" : "scans", seconds, context_.attributes};
  job.content = store_.save(decision.recipe, kind_of(*value), arrays_from(*value), note);
  job.verdict = Verdict::done;
  record(mean.name, seconds);
  return value;
}

std::optional<Histogram> Runner::mean(std::size_t index, bool meshes) {
  const ValuePtr& value = means_.at(index)[meshes ? 0 : 1];
  return value ? std::optional(std::get<Histogram>(*value)) : std::nullopt;
}

Value Runner::result(const ItemRef& item, std::size_t stage) {
  return *FamilyRun(*this, item.family).value(item, stage);
}

std::size_t Runner::computed() const {
  std::size_t sum = 0;
  for (const auto& [stage, timing] : timings_) sum += timing.computed;
  return sum;
}

void Runner::record(Failure failure) {
  spdlog::error("{}: {}: {}", context_.name(failure.item), failure.stage, failure.cause);
  const std::lock_guard lock(mutex_);
  failures_.push_back(std::move(failure));
}

void Runner::record(const std::string& stage, double seconds) {
  const std::lock_guard lock(mutex_);
  ++timings_[stage].computed;
  timings_[stage].seconds += seconds;
}

}  // namespace salbench
