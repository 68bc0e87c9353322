// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/executor.h"

#include <new>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/process.h"
#include "pipeline/plan/remark.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Counts a job as long as it lives, however the job ends.
class AtWork {
 public:
  explicit AtWork(std::atomic<int>& jobs) : jobs_(jobs) { ++jobs_; }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
  ~AtWork() { --jobs_; }

 private:
  std::atomic<int>& jobs_;
};

}  // namespace

Executor::Executor(const Context& context, Plan& plan, Store& store, Damaged damaged)
    : context_(context),
      plan_(plan),
      store_(store),
      damaged_(damaged),
      records_(plan.jobs.size()),
      running_(plan.jobs.size()) {
  for (const std::vector<Job>& jobs : plan.jobs) values_.emplace_back(jobs.size());
}

void Executor::settle(const JobRef& ref) {
  Job& job = plan_[ref];
  // The key is of what the files hold now: they may have been edited since they were planned with.
  std::vector<SourceData> files = read_again(sources_of(context_, ref));
  // The plan's reason is kept: why the job was computed is asked afterwards.
  const Reason reason = job.reason;
  job = decide(context_, plan_, ref, [&](std::string_view stage, const Digest& key) {
    return store_.refresh_and_find(stage, key);
  });
  if (job.verdict == Verdict::compute) {
    if (job.reason != Reason::unreadable) job.reason = reason;
    compute(ref, std::move(files));
    if (job.open()) return;
  }
  const std::lock_guard lock(mutex_);
  ++records_[ref.row].settled;
}

void Executor::compute(const JobRef& ref, std::vector<SourceData> files) {
  for (const SourceFile& file : sources_of(context_, ref))
    if (!file.digest) return fail(ref, file.error);
  Job& job = plan_[ref];
  try {
    Result result = run(ref, std::move(files));
    job.content = store(ref, recipe_of(context_, plan_, ref), result);
    job.verdict = Verdict::done;
    hold(ref, std::make_shared<const Value>(std::move(result.value)));
  } catch (const StorageError&) {
    throw;
  } catch (const CommandInterrupted&) {  // the job stays open: a later run computes it
  } catch (const InputError& error) {
    fail(ref, error.what());
  } catch (const std::bad_alloc&) {
    const SourceFiles& read = sources_of(context_, ref);
    if (read.empty()) return fail(ref, current_defect(), true);
    fail(ref,
         fmt::format("{}{}: no memory for what it holds; use fewer --threads, or leave the item out with "
                     "--items",
                     read[0].place, read.size() == 1 ? "" : fmt::format(" and {} more", read.size() - 1)));
  } catch (...) {
    fail(ref, current_defect(), true);
  }
}

void Executor::fail(const JobRef& job, std::string cause, bool defect) {
  plan_[job].verdict = Verdict::failed;
  spdlog::error("{}: {}: {}", context_.name(job), context_.row(job).name, cause);
  const std::lock_guard lock(mutex_);
  failures_.push_back({job, std::move(cause), defect});
}

ValuePtr Executor::held(const JobRef& job) {
  const std::lock_guard lock(mutex_);
  return values_[job.row][job.item.index()];
}

void Executor::hold(const JobRef& job, ValuePtr value) {
  const std::lock_guard lock(mutex_);
  values_[job.row][job.item.index()] = std::move(value);
}

void Executor::forget(const Item& item) {
  for (const JobRef& job : jobs_of(context_.catalog, item)) hold(job, nullptr);
  if (item.is_scan()) return;
  const std::lock_guard lock(mutex_);
  std::erase_if(preparations_, [&](const auto& entry) { return entry.first.second == item.family; });
}

std::shared_ptr<Preparation> Executor::preparation(const JobRef& job) {
  if (!context_.row(job).prepares) return nullptr;
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Preparation>& kept = preparations_[{job.row, job.item.family}];
  if (kept == nullptr) kept = std::make_shared<Preparation>();
  return kept;
}

// Two rows that ask at the same time may load it twice; neither waits for the other.
ValuePtr Executor::input(const JobRef& job) {
  ValuePtr value = load(job);
  hold(job, value);
  return value;
}

ValuePtr Executor::load(const JobRef& job) {
  if (const ValuePtr& given = context_.row(job).given) return given;
  if (ValuePtr value = held(job)) return value;
  const Row& row = context_.row(job);
  if (const auto arrays = store_.load(row.name, plan_[job].key))
    return std::make_shared<const Value>(value_from(row.kind, *arrays));
  if (damaged_ == Damaged::report)
    throw InputError(fmt::format("the artefact of {} that it reads is damaged", row.name));
  return restored(job);
}

ValuePtr Executor::restored(const JobRef& ref) {
  const std::lock_guard lock(restoring_);
  if (ValuePtr value = held(ref)) return value;
  Job& job = plan_[ref];
  job.reason = Reason::damaged;
  Result result = run(ref, read_unchanged(sources_of(context_, ref)));
  if (store(ref, recipe_of(context_, plan_, ref), result) != job.content)
    throw std::logic_error(
        fmt::format("stage {} gave another result than before for the same inputs: it is not "
                    "deterministic; please report this",
                    context_.row(ref).name));
  auto value = std::make_shared<const Value>(std::move(result.value));
  hold(ref, value);  // for those that wait for the same one
  return value;
}

Value Executor::recompute(const JobRef& job) {
  return run(job, read_unchanged(sources_of(context_, job))).value;
}

Executor::Result Executor::run(const JobRef& job, std::vector<SourceData> files) {
  const Row& row = context_.row(job);
  std::string remark;
  JobInputs inputs{.files = std::move(files),
                   .source = &context_.source(job.item),
                   .random = {context_.seed, context_.name(job)},
                   .view = job.item.view,
                   .remark = &remark,
                   .preparation = preparation(job)};
  std::vector<JobRef> members;
  for (std::size_t i = 0; i < row.inputs.size(); ++i)
    for (const JobRef& read : input_jobs(context_, job, i)) {
      if (!row.gathers)
        inputs.values.push_back(input(read));
      else if (plan_[read].known())
        members.push_back(read);
    }
  inputs.members = members.size();
  inputs.member = [&](std::size_t i) { return load(members[i]); };

  const AtWork at_work(running_[job.row]);
  const auto started = Clock::now();
  Value value = row.run(inputs);
  Result result{std::move(value), std::move(remark), started, seconds_since(started)};
  return result;
}

Digest Executor::store(const JobRef& job, const Recipe& recipe, const Result& result) {
  const ArtefactNote note{context_.name(job), result.seconds, context_.attributes};
  // First: who finds the result in the cache finds the remark.
  if (!result.remark.empty()) save_remark(store_, recipe.stage, key_of(recipe), note, result.remark);
  const Digest content = store_.save(recipe, context_.row(job).kind, arrays_from(result.value), note);
  const std::lock_guard lock(mutex_);
  records_[job.row].seconds.push_back(static_cast<float>(result.seconds));
  records_[job.row].started.push_back(result.started);
  return content;
}

std::string Executor::at_work() const {
  std::map<std::string_view, int> jobs;
  for (std::size_t row = 0; row < running_.size(); ++row)
    if (const int n = running_[row]; n > 0) jobs[context_.catalog.rows[row].name] += n;
  std::string text;
  for (const auto& [name, n] : jobs)
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", n > 1 ? fmt::format("{} ", n) : "", name);
  return text;
}

}  // namespace salbench
