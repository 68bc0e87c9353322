// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/resolver.h"

#include <algorithm>
#include <cctype>
#include <new>
#include <ranges>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

thread_local Clock::duration waited = {};  // queueing time of the running function

// Files of a job that waited, read once for both key and computation.
std::vector<FileData> read_at_first(std::span<File> files) try {
  const auto is_new = [](const File& file) { return !file.is_known(); };
  return std::ranges::all_of(files, is_new) ? read_files(files) : std::vector<FileData>();
} catch (const InputError&) {  // reported by the job
  return {};
}

// True if `word` occurs at this position as a whole word.
bool has_word_at(std::string_view text, std::size_t at, std::string_view word) {
  const auto is_of_word = [&](std::size_t place) {
    return place < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[place])) != 0 || text[place] == '_');
  };
  return text.substr(at).starts_with(word) && !is_of_word(at - 1) && !is_of_word(at + word.size());
}

struct NamedCause {
  std::string name, cause;  // name and failure of an item
};

// True if two failures differ only in the name of their item. An item's number may also occur in both within
// a path or a version.
bool are_alike(const NamedCause& a, const NamedCause& b) {
  std::size_t i = 0, j = 0;
  while (i < a.cause.size() && j < b.cause.size()) {
    if (has_word_at(a.cause, i, a.name) && has_word_at(b.cause, j, b.name)) {
      i += a.name.size();
      j += b.name.size();
    } else if (a.cause[i++] != b.cause[j++]) {
      return false;
    }
  }
  return i == a.cause.size() && j == b.cause.size();
}

std::string no_memory_text(std::span<const File> files) {
  return fmt::format("{}{}: no memory for what it holds; use fewer {}, or leave the item out with {}",
                     files[0].place, files.size() == 1 ? "" : fmt::format(" and {} more", files.size() - 1),
                     as_option("threads"), as_option("items"));
}

}  // namespace

void note_waiting(Clock::duration time) { waited += time; }

// Counts a running job for its lifetime. Enforces the stage's limit as well, since the graph does not see
// jobs that are restored inside another one. A gathering job counts as one.
class Resolver::AtWork {
 public:
  AtWork(Resolver& resolver, std::size_t rule) : of_(resolver), rule_(rule) {
    std::unique_lock lock(of_.mutex_);
    of_.ended_.wait(lock, [&] { return has_room(); });
    ++of_.running_[rule_];
  }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
  ~AtWork() {
    const std::lock_guard lock(of_.mutex_);
    --of_.running_[rule_];
    of_.ended_.notify_all();
  }

 private:
  bool has_room() const {
    const Rules& rules = of_.project_.rules;
    if (rules[rule_].limit == 0 || rules[rule_].gathers) return true;
    std::size_t jobs = 0;
    for (std::size_t rule = 0; rule < rules.size(); ++rule)
      if (rules[rule].stage == rules[rule_].stage) jobs += of_.running_[rule];
    return jobs < rules[rule_].limit;
  }

  Resolver& of_;
  std::size_t rule_;
};

Resolver::Resolver(const Project& project, Plan plan, Store& store, Damaged damaged)
    : project_(project),
      plan_(std::move(plan)),
      store_(store),
      damaged_(damaged),
      records_(project.rules.size()),
      running_(project.rules.size()) {}

void Resolver::settle_job(const Job& job) {
  Decision& decision = plan_[job];
  std::vector<FileData> files = read_at_first(project_.files(job));
  // Keeps the plan's reason, which is reported after the run.
  const Reason reason = decision.reason;
  decision = decide(project_, plan_, job, store_);
  if (decision.open() && !decision.waits()) {
    compute_and_save(job, std::move(files));
    if (decision.known()) decision.reason = reason;
  }
  if (decision.open()) return;
  const std::lock_guard lock(mutex_);
  ++records_[job.rule].settled;
}

void Resolver::compute_and_save(const Job& job, std::vector<FileData> files) {
  try {
    Result result = result_of(job, std::move(files));
    plan_[job].content = save(job, result);
    plan_[job].state = State::known;
    hold(job, result.value);
  } catch (const StorageError&) {
    throw;
  } catch (const Interrupted&) {  // stays open for a later run
  } catch (const InputError& error) {
    record_failure(job, error.what());
  } catch (const std::bad_alloc&) {
    const std::span<const File> read = project_.files(job);
    read.empty() ? record_failure(job, current_defect(), true) : record_failure(job, no_memory_text(read));
  } catch (const std::system_error& error) {
    throw StorageError(refusal_text(error));
  } catch (...) {
    record_failure(job, current_defect(), true);
  }
}

void Resolver::record_failure(const Job& job, std::string cause, bool defect) {
  plan_[job].state = State::failed;
  const std::string line = fmt::format("{}: {}: {}", project_.name(job), project_.rule(job).stage, cause);
  if (!defect && !project_.units.is_chosen(job.unit))
    return spdlog::warn("{}; what is gathered of all is without it", line);
  const std::lock_guard lock(mutex_);
  holds_messages_ ? void(held_messages_[job] = line) : spdlog::error("{}", line);
  failures_.push_back({job, std::move(cause), defect});
}

void Resolver::hold_messages() { holds_messages_ = true; }

void Resolver::say_messages() {
  holds_messages_ = false;
  for (const auto& [job, line] : held_messages_) spdlog::error("{}", line);
  held_messages_.clear();
}

void Resolver::give_up_if_alike(const std::vector<Job>& jobs, std::size_t first) {
  std::vector<NamedCause> found;
  for (std::size_t i = 0; i < first; ++i) {
    const auto failure = std::ranges::find(failures_, jobs[i], &Failure::job);
    if (failure == failures_.end() || failure->defect) return;
    found.push_back({project_.name(jobs[i]), failure->cause});
    if (!are_alike(found[0], found[i])) return;
  }
  std::size_t others = 0;
  for (const Job& job : jobs)
    if (Decision& decision = plan_[job]; decision.open()) {
      decision.state = State::failed;
      ++others;
    }
  for (std::size_t i = 0; i < first; ++i) held_messages_.erase(jobs[i]);
  const Rule& rule = project_.rule(jobs[0]);
  spdlog::error(
      "{}: {}: failed alike on its first {} items ({}), and is not tried on the other {}; {} tries all",
      rule.stage, found[0].cause, first, fmt::join(found | std::views::transform(&NamedCause::name), ", "),
      others, options_are_arguments ? "keep_going=True" : "--keep-going");
}

ValuePtr Resolver::held(const Job& job) {
  const std::lock_guard lock(mutex_);
  const auto found = values_.find({job.unit, job.rule});
  return found == values_.end() ? nullptr : found->second;
}

ValuePtr Resolver::hold(const Job& job, const ValuePtr& value) {
  const std::lock_guard lock(mutex_);
  return values_.try_emplace({job.unit, job.rule}, value).first->second;
}

void Resolver::forget(Unit unit) {
  const std::lock_guard lock(mutex_);
  values_.erase(values_.lower_bound({unit, 0}), values_.upper_bound({unit, project_.rules.size()}));
}

void Resolver::forget_all() {
  const std::lock_guard lock(mutex_);
  values_.clear();
}

ValuePtr Resolver::value(const Job& job) {
  const Rule& rule = project_.rule(job);
  if (rule.given) return rule.given;
  if (ValuePtr value = held(job)) return value;
  if (const auto arrays = store_.load(plan_[job].key)) return rule.read(*arrays);
  if (damaged_ == Damaged::report)
    throw InputError(fmt::format("the artefact of {} that it reads is damaged", rule.stage));
  return restored(job);
}

ValuePtr Resolver::restored(const Job& job) {
  const std::lock_guard lock(restoring_);
  if (ValuePtr value = held(job)) return value;
  plan_[job].reason = Reason::damaged;
  const Result result = result_of(job);
  const Rule& rule = project_.rule(job);
  // A different result is not stored: dependent results contain the digest of the first.
  if (content_digest(rule.arrays(*result.value)) != plan_[job].content) {
    if (rule.is_foreign)
      throw InputError(fmt::format(
          "the artefact of {} was damaged, and the model gives another map each time: fix its seeds, "
          "and run it again",
          rule.stage));
    throw std::logic_error(fmt::format(
        "stage {} gave another result than before for the same inputs: it is not deterministic", rule.stage));
  }
  save(job, result);
  store_.flush(project_.family(job));  // may have been flushed long ago
  return hold(job, result.value);      // for concurrent readers of the same value
}

ValuePtr Resolver::value_so_far(const Job& job) { return plan_[job].known() ? value(job) : recompute(job); }

ValuePtr Resolver::recompute(const Job& job) { return result_of(job).value; }

Resolver::Result Resolver::result_of(const Job& job, std::vector<FileData> files) {
  const Rule& rule = project_.rule(job);
  Result result;
  if (files.empty()) files = read_files(project_.files(job));
  JobInputs inputs{.files = std::move(files),
                   .text = rule.text.in(job.unit).value_or(""),
                   .random = {project_.seed, project_.name(job)},
                   .remark = &result.remark};
  if (!rule.gathers) {
    // Held as a result of the family's first unit, for which the rule has none. No lock is held while it is
    // computed: a waiting thread may pick up another job that asks for the same value.
    const Job shared{job.rule, project_.units.above(job.unit, project_.units.source_of(job.unit).level)};
    if (shared != job)
      inputs.once = [this, shared](const std::function<ValuePtr()>& make) {
        const ValuePtr known = held(shared);
        return known ? known : hold(shared, make());
      };
    inputs.source = &project_.units.source_of(job.unit).source;
    inputs.place = project_.units.place(job.unit);
  }
  std::vector<Job> members;
  for (std::size_t i = 0; i < rule.inputs.size(); ++i)
    for (const Job& read : project_.input_jobs(job, i)) {
      if (!rule.gathers) {
        // Concurrent rules may load it twice instead of waiting for each other.
        inputs.values.push_back(hold(read, value(read)));
      } else if (plan_[read].known()) {
        members.push_back(read);
      }
    }
  inputs.members = members.size();
  inputs.member = [&](std::size_t i) { return value(members[i]); };

  const AtWork at_work(*this, job.rule);
  const ProcessorTime processor;
  const Clock::duration around = std::exchange(waited, {});  // queueing time of the enclosing job
  const Clock::time_point began = Clock::now();
  result.value = rule.compute(inputs);
  result.seconds =
      std::chrono::duration<double>(Clock::now() - began - std::exchange(waited, around)).count();
  result.processor_seconds = processor.seconds();
  return result;
}

Digest Resolver::save(const Job& job, const Result& result) {
  const Rule& rule = project_.rule(job);
  Recipe recipe = recipe_of(project_, plan_, job);
  if (key_of(recipe) != plan_[job].key)  // damaged, and stored under another name
    for (const Recipe& renamed : renamed_recipes_of(project_, plan_, job, store_))
      if (key_of(renamed) == plan_[job].key) recipe = renamed;
  ArtefactNote note{project_.name(job), result.seconds, result.remark, project_.attributes};
  // Processes, threads and devices of a user's command or function are not measured.
  if (!rule.is_foreign) note.attributes.emplace_back(kProcessorSeconds, result.processor_seconds);
  Artefact artefact = artefact_of(std::move(recipe), rule.kind, rule.arrays(*result.value), std::move(note));
  const Digest content = artefact.content;
  store_.save(project_.family(job), std::move(artefact));
  const std::lock_guard lock(mutex_);
  records_[job.rule].seconds.push_back(static_cast<float>(result.seconds));
  records_[job.rule].processor_seconds += result.processor_seconds;
  return content;
}

std::vector<Failure> Resolver::failures() const {
  std::vector<Failure> failures = failures_;
  const auto place = [&](const Failure& failure) {
    const Unit unit = failure.job.unit;
    const std::size_t family = unit.level == kRoot ? 0 : project_.units.family_of(unit);
    return std::tuple(family, unit, failure.job.rule);
  };
  std::ranges::stable_sort(failures, {}, place);
  return failures;
}

std::size_t Resolver::computed() const {
  std::size_t sum = 0;
  for (const RuleRecord& record : records_) sum += record.seconds.size();
  return sum;
}

std::string Resolver::at_work() const {
  std::map<std::string_view, std::size_t> jobs;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t rule = 0; rule < running_.size(); ++rule)
      if (running_[rule] > 0) jobs[project_.rules[rule].stage] += running_[rule];
  }
  std::string text;
  for (const auto& [stage, n] : jobs)
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", n > 1 ? fmt::format("{} ", n) : "", stage);
  return text;
}

}  // namespace salbench
