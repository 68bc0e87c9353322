// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/verify.h"

#include <algorithm>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct VerifyOptions {
  std::vector<std::string> configs;  // may be empty where the command line names a cache
  bool deep = false;
  int sample = 20;  // jobs computed again, per configuration
};

std::vector<JobRef> cached_jobs(const Context& context, const Plan& plan) {
  std::vector<JobRef> cached;
  for (std::size_t row = 0; row < plan.jobs.size(); ++row)
    for (const Item& item : items_of(context, row))
      if (plan[{row, item}].verdict == Verdict::cached) cached.push_back({row, item});
  return cached;
}

// Recomputes a cached job and describes the first difference; empty if there is none.
std::string recomputed_fault(Executor& executor, const JobRef& job, const Digest& expected) try {
  const Digest content = content_digest(arrays_from(executor.recompute(job)));
  for (const Item& item : {job.item, Item::mesh(job.item.family)}) executor.forget(item);
  if (content == expected) return {};
  return fmt::format(
      "computed again, its content is {}: the stage is not deterministic, or its version was not raised",
      content.hex());
} catch (const InputError& error) {
  return fmt::format("cannot be computed again: {}", error.what());
} catch (const StorageError&) {
  throw;
} catch (...) {
  return current_defect();
}

void print_faults(const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) fmt::print("{}: {}\n", fault.file.string(), fault.what);
}

std::size_t verify_folder(const fs::path& folder, bool quiet, const std::atomic<bool>& stop) {
  const OrderlyEnd orderly;
  const Verification result = verify_cache(folder, stop, *progress_of(quiet));
  print_faults(result.faults);
  if (!quiet)
    fmt::print("{}: {} artefacts, {:.1f} MB: {} bad{}\n", folder.string(), result.artefacts,
               static_cast<double>(result.bytes) / 1e6, result.faults.size(),
               result.others > 0 ? fmt::format("; {} other files, left alone", result.others) : "");
  return result.faults.size();
}

std::size_t verify_sample(const Setup& setup, std::size_t sample, bool quiet, const std::atomic<bool>& stop) {
  FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.context, store);
  const OrderlyEnd orderly;
  const Recomputation result = recompute_sample(setup.context, plan, store, sample, stop);
  print_faults(result.faults);
  if (!quiet)
    fmt::print("{}: {} of its jobs computed again: {} came out otherwise\n", setup.config.name, result.jobs,
               result.faults.size());
  return result.faults.size();
}

ExitStatus run_verify(Arguments arguments, const VerifyOptions& options, const std::atomic<bool>& stop) {
  if (options.configs.empty() && (arguments.cache.empty() || options.deep))
    throw ConfigError(options.deep ? "--deep needs a configuration: it says what to compute again"
                                   : "name a configuration, or a cache with --cache DIR");
  std::size_t faults = 0;
  std::set<fs::path> seen;
  if (options.configs.empty()) faults += verify_folder(arguments.cache, arguments.quiet, stop);
  for (const std::string& config : options.configs) {
    arguments.config = config;
    const Setup setup(arguments, {}, Pictures::cached);
    if (seen.insert(fs::weakly_canonical(setup.cache)).second)
      faults += verify_folder(setup.cache, arguments.quiet, stop);
    if (options.deep)
      faults += verify_sample(setup, static_cast<std::size_t>(options.sample), arguments.quiet, stop);
  }
  if (stop) return interrupted_status(arguments);
  return faults == 0 ? kAllDone : kSomeFailed;
}

}  // namespace

Recomputation recompute_sample(const Context& context, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop) {
  std::vector<JobRef> jobs = cached_jobs(context, plan);
  Rng rng(context.seed, "verify", "");
  Plan copy = plan;
  Executor executor(context, copy, store, Executor::Damaged::report);
  Recomputation result;
  for (std::size_t i = 0; i < std::min(sample, jobs.size()) && !stop; ++i) {
    std::swap(jobs[i], jobs[i + rng.below(jobs.size() - i)]);
    const std::string& stage = context.row(jobs[i]).name;
    const auto file = store.path(stage, plan[jobs[i]].key);
    std::string fault = recomputed_fault(executor, jobs[i], plan[jobs[i]].content);
    if (!fault.empty()) result.faults.push_back({file.value_or(stage), std::move(fault)});
    ++result.jobs;
  }
  return result;
}

Subcommand verify_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<VerifyOptions>();
  return {
      "verify", "read every artefact of a cache and name each bad one; changes nothing",
      cache_parameters(arguments, {{"CONFIG", &options->configs, "configuration files, or none with --cache"},
                                   {"--deep", &options->deep,
                                    "also compute a sample of the cached jobs again, and compare"},
                                   {"--sample", &options->sample, "how many (default: 20)"}}),
      [&arguments, options](const std::atomic<bool>& stop) { return run_verify(arguments, *options, stop); }};
}

}  // namespace salbench
