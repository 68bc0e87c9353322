// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/run.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <malloc.h>

#include "pipeline/engine/graph.h"

namespace salbench {
namespace {

// Shows progress for its lifetime; afterwards running jobs are no longer queried.
class Reported {
 public:
  Reported(Progress& progress, const std::string& what, std::size_t items,
           std::function<std::string()> at_work)
      : progress_(progress) {
    progress_.begin(what, items, std::move(at_work));
  }
  Reported(const Reported&) = delete;
  Reported& operator=(const Reported&) = delete;
  ~Reported() { progress_.end(); }

 private:
  Progress& progress_;
};

// Interval of polling for claims that other processes have released; it grows, so that waiting is cheap.
constexpr std::chrono::milliseconds kFirstPoll(20), kLongestPoll(500);
// Large arrays of a family leave holes that small, long-lived allocations pin. Unless free memory is returned
// to the system, it grows with every family, to ten times the memory in use.
constexpr std::size_t kFamiliesPerTrim = 16;

using Mask = std::vector<bool>;  // [rule]

// Identified by its first file's content: families of equal name in two data sets are different work.
std::string work_of(const Project& project, std::size_t family) {
  const Family& entering = project.units.families()[family];
  for (const Job& job : project.jobs_of({entering.level, static_cast<std::uint32_t>(family)}))
    if (const std::span<File> files = project.files(job); !files.empty() && files[0].is_known())
      if (const auto digest = files[0].digest()) return "family " + digest->hex();
  return "family " + entering.name;
}

class Strata {
 public:
  Strata(Resolver& resolver, const RunOptions& options, Progress& progress, const std::atomic<bool>& stop)
      : project_(resolver.project()),
        resolver_(resolver),
        options_(options),
        progress_(progress),
        stop_(stop) {}

  void run_all() {
    if (options_.tries > 0) try_foreign();
    const std::vector<std::size_t> stratum = strata(project_.rules);
    for (std::size_t s = 0; has_work(resolver_) && !stop_; ++s) {
      Mask now(stratum.size());
      for (std::size_t rule = 0; rule < now.size(); ++rule) now[rule] = stratum[rule] <= s;
      run_stratum(ends_of(stratum, s), now);
    }
    resolver_.store().flush_all();
  }

 private:
  std::size_t open(const Mask& rules) const {
    std::size_t jobs = 0;
    for (std::size_t rule = 0; rule < rules.size(); ++rule)
      if (rules[rule]) jobs += resolver_.plan().open(rule);
    return jobs;
  }

  // --- foreign stages ---

  // Open jobs of each foreign stage without a result that has more of them than it may fail. Different
  // families come first, in their order: one family may be odd in all of its units.
  std::vector<std::vector<Job>> untried() const {
    std::map<std::string_view, std::vector<Job>> by_stage;
    for (std::size_t rule = 0; rule < project_.rules.size(); ++rule)
      if (project_.rules[rule].is_foreign)
        std::ranges::copy(project_.jobs_of_rule(rule),
                          std::back_inserter(by_stage[project_.rules[rule].stage]));
    std::vector<std::vector<Job>> untried;
    for (auto& [stage, jobs] : by_stage) {
      if (std::ranges::any_of(jobs, [&](const Job& job) { return resolver_.plan()[job].known(); })) continue;
      std::erase_if(jobs, [&](const Job& job) { return !resolver_.plan()[job].open(); });
      if (jobs.size() <= options_.tries) continue;
      const Units& units = project_.units;
      std::ranges::sort(jobs, {}, [&](const Job& job) {
        return std::tuple(job.unit.level, units.place(job.unit), units.family_of(job.unit));
      });
      untried.push_back(std::move(jobs));
    }
    return untried;
  }

  // The jobs with all open jobs that they read.
  std::set<Job> with_inputs(std::vector<Job> jobs) const {
    std::set<Job> all;
    while (!jobs.empty()) {
      const Job job = jobs.back();
      jobs.pop_back();
      if (!resolver_.plan()[job].open() || !all.insert(job).second) continue;
      for (std::size_t i = 0; i < project_.rule(job).inputs.size(); ++i)
        std::ranges::copy(project_.input_jobs(job, i), std::back_inserter(jobs));
    }
    return all;
  }

  void try_foreign() {
    const std::vector<std::vector<Job>> stages = untried();
    if (stages.empty()) return;
    std::vector<Job> first;
    for (const std::vector<Job>& jobs : stages)
      first.insert(first.end(), jobs.begin(), jobs.begin() + static_cast<std::ptrdiff_t>(options_.tries));
    const std::set<Job> now = with_inputs(first);
    resolver_.store().prepare();
    const Reported reported(progress_, "first tries", now.size(), [this] { return resolver_.at_work(); });
    resolver_.hold_messages();
    const auto open_now = [&] {
      return std::ranges::count_if(now, [&](const Job& job) { return resolver_.plan()[job].open(); });
    };
    for (auto before = open_now() + 1, left = open_now(); left > 0 && left < before && !stop_;) {
      stream_once([&](const Job& job) { return now.contains(job); });
      before = std::exchange(left, open_now());
    }
    for (const std::vector<Job>& jobs : stages) resolver_.give_up_if_alike(jobs, options_.tries);
    resolver_.say_messages();
  }

  // Names a stratum by a value that it gathers for later ones.
  std::string ends_of(const std::vector<std::size_t>& stratum, std::size_t number) const {
    if (number == std::ranges::max(stratum)) return "evaluation";
    for (std::size_t rule = 0; rule < stratum.size(); ++rule)
      if (stratum[rule] == number && project_.rules[rule].gathers) return project_.rules[rule].stage;
    return {};
  }

  // Holds no claim while waiting for others, so that processes never deadlock. While others hold what is to
  // be gathered, jobs that do not need it continue.
  void run_stratum(const std::string& what, const Mask& rules) {
    while (open(rules) > 0 && !stop_) {
      const std::vector<std::string> claimed = stream_until_blocked(what, rules);
      if (open(rules) == 0 || stop_) return;
      const Mask without = without_gathered();
      const std::size_t before = open(without);
      if (before > 0) stream_until_blocked("stages ahead of the " + what, without);
      if (open(without) < before) continue;
      if (claimed.empty()) throw std::logic_error(deadlock_text(rules));
      await_any(claimed);
    }
  }

  std::string deadlock_text(const Mask& rules) const {
    for (const Job& job : project_.jobs())
      if (rules[job.rule] && resolver_.plan()[job].open())
        return fmt::format("deadlock: {} open jobs have no runnable input (first: {} of {})", open(rules),
                           project_.rule(job).stage, project_.name(job));
    return "deadlock";
  }

  // Rules that do not need a gathered value that is still unknown.
  Mask without_gathered() const {
    Mask without(project_.rules.size(), false);
    for (std::size_t rule = 0; rule < without.size(); ++rule)
      without[rule] =
          !project_.rules[rule].gathers &&
          std::ranges::all_of(project_.rules[rule].inputs, [&](std::size_t input) {
            return project_.rules[input].gathers ? resolver_.plan().open(input) == 0 : without[input];
          });
    return without;
  }

  // Runs jobs until other processes have claimed all that remain; returns those claims.
  std::vector<std::string> stream_until_blocked(const std::string& what, const Mask& rules) {
    std::size_t left = open(rules);
    std::vector<std::string> claimed;
    resolver_.store().prepare();
    const Reported reported(progress_, what, left, [this] { return resolver_.at_work(); });
    for (bool goes_on = true; goes_on;) {
      const std::size_t before = left;
      claimed = stream_once([&](const Job& job) { return rules[job.rule]; });
      left = open(rules);
      goes_on = left < before && left > 0 && !stop_;
    }
    return claimed;
  }

  // Returns when any claim is released: others may be held for hours.
  void await_any(const std::vector<std::string>& claimed) const {
    const auto is_claimed = [&](const std::string& work) { return resolver_.store().is_claimed(work); };
    for (auto pause = kFirstPoll; !stop_ && std::ranges::all_of(claimed, is_claimed);
         pause = std::min(2 * pause, kLongestPoll))
      std::this_thread::sleep_for(pause);
  }

  // Returns the families and gathered values that other processes have claimed.
  template <class IsWanted>
  std::vector<std::string> stream_once(const IsWanted& is_wanted) {
    std::vector<std::unique_ptr<Claim>> claims(project_.units.families().size());
    std::vector<std::string> claimed_by_others;
    std::mutex refusing;
    const auto claim_of = [&](const std::string& work) {
      std::unique_ptr<Claim> claim = resolver_.store().claim(work);
      const std::scoped_lock lock(refusing);
      if (!claim) claimed_by_others.push_back(work);
      return claim;
    };
    std::vector<std::vector<std::atomic<std::size_t>>> open_of_unit;  // [level][index]
    for (std::size_t level = 0; level < project_.units.levels().size(); ++level)
      open_of_unit.emplace_back(project_.units.slots(static_cast<Level>(level)));
    const auto is_open = [&](const Job& job) {
      const bool to_do = is_wanted(job) && resolver_.plan()[job].open();
      if (to_do) ++open_of_unit[job.unit.level][job.unit.index];
      return to_do;
    };
    const auto settle_job = [&](const Job& job) {
      std::unique_ptr<Claim> claim;
      if (job.unit.level == kRoot) {
        claim = claim_of(project_.rule(job).stage + " " + project_.name(job));
        if (!claim) return false;
        resolver_.store().refresh({});
      }
      resolver_.settle_job(job);
      if (claim) resolver_.store().flush({});
      // Values of a part are read by its own jobs only, and dropped after the last.
      if (--open_of_unit[job.unit.level][job.unit.index] == 0 &&
          project_.units.levels()[job.unit.level].head != kRoot)
        resolver_.forget(job.unit);
      progress_.item_done();
      return true;
    };
    const auto enter_family = [&](std::size_t family) {
      claims[family] = claim_of(work_of(project_, family));
      if (claims[family]) resolver_.store().refresh(project_.units.families()[family].name);
      return claims[family] != nullptr;
    };
    std::atomic<std::size_t> left = 0;
    const auto leave_family = [&](std::size_t family) {
      for (const Unit unit : project_.units.of_family(family)) resolver_.forget(unit);
      resolver_.store().flush(project_.units.families()[family].name);
      claims[family].reset();
      if (++left % kFamiliesPerTrim == 0) malloc_trim(0);
    };
    stream_jobs(project_, {.threads = options_.threads, .families = options_.threads + 1}, stop_,
                {is_open, enter_family, settle_job, leave_family});
    return claimed_by_others;
  }

  const Project& project_;
  Resolver& resolver_;
  const RunOptions& options_;
  Progress& progress_;
  const std::atomic<bool>& stop_;
};

}  // namespace

std::vector<std::size_t> strata(const Rules& rules) {
  // Length of the longest chain of gathered values that a rule needs.
  std::vector<std::size_t> gathered(rules.size(), 0);
  std::size_t last = 0;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    for (const std::size_t input : rules[r].inputs)
      gathered[r] = std::max(gathered[r], gathered[input] + (rules[input].gathers ? 1 : 0));
    last = std::max(last, gathered[r]);
  }
  // A gathered value that others read ends its stratum, and its inputs lie there or earlier; every other rule
  // runs as late as its readers allow.
  std::vector<std::size_t> of_rule(rules.size(), last);
  for (std::size_t r = rules.size(); r-- > 0;)
    for (const std::size_t input : rules[r].inputs)
      of_rule[input] = std::min(of_rule[input], rules[input].gathers ? gathered[input] : of_rule[r]);
  return of_rule;
}

bool has_work(const Resolver& resolver) {
  return std::ranges::any_of(resolver.plan().decisions, [](const std::vector<Decision>& of_rule) {
    return std::ranges::any_of(of_rule, &Decision::open);
  });
}

void run_jobs(Resolver& resolver, const RunOptions& options, Progress& progress,
              const std::atomic<bool>& stop) {
  Strata(resolver, options, progress, stop).run_all();
}

}  // namespace salbench
