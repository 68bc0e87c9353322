// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/engine/maintain.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct VerifyOptions {
  std::vector<std::string> configs;  // may be empty where the command line names a cache
  bool deep = false;
  int sample = 20;  // jobs computed again, per configuration
};

struct CheckedCache {
  fs::path cache;
  Verification found;
};

struct CheckedSample {
  std::string configuration;
  Recomputation found;
};

struct VerifyReport {
  std::vector<CheckedCache> caches;
  std::vector<CheckedSample> samples;
  bool interrupted = false;
};

Json faults_json(const std::vector<Fault>& faults) {
  return list_of(faults, [](const Fault& fault) { return Json{{"file", fault.file}, {"what", fault.what}}; });
}

Json json_of(const VerifyReport& report) {
  return {{"caches", list_of(report.caches,
                             [](const CheckedCache& checked) {
                               const Verification& found = checked.found;
                               return Json{{"cache", checked.cache},
                                           {"artefacts", found.artefacts},
                                           {"bytes", found.bytes},
                                           {"other_files", found.others},
                                           {"faults", faults_json(found.faults)}};
                             })},
          {"samples", list_of(report.samples,
                              [](const CheckedSample& checked) {
                                return Json{{"configuration", checked.configuration},
                                            {"jobs", checked.found.jobs},
                                            {"faults", faults_json(checked.found.faults)}};
                              })},
          {"interrupted", report.interrupted}};
}

std::string summary_of(const CheckedCache& checked) {
  const Verification& found = checked.found;
  return fmt::format("{}: {} artefacts, {:.1f} MB: {} bad{}\n", checked.cache.string(), found.artefacts,
                     static_cast<double>(found.bytes) / 1e6, found.faults.size(),
                     found.others > 0 ? fmt::format("; {} other files, left alone", found.others) : "");
}

std::string summary_of(const CheckedSample& checked) {
  return fmt::format("{}: {} of its jobs computed again: {} came out otherwise\n", checked.configuration,
                     checked.found.jobs, checked.found.faults.size());
}

// Text goes out as soon as a check ends: the next one may take long, or find its cache unusable.
template <class Checked>
void add(ReportFormat format, bool quiet, Checked checked, std::vector<Checked>& all) {
  if (format == ReportFormat::text) {
    for (const Fault& fault : checked.found.faults) fmt::print("{}: {}\n", fault.file.string(), fault.what);
    if (!quiet) fmt::print("{}", summary_of(checked));
  }
  all.push_back(std::move(checked));
}

CheckedCache verified(const fs::path& cache, bool quiet, const std::atomic<bool>& stop) {
  const OrderlyEnd orderly;
  return {cache, verify_cache(cache, stop, *progress_of(quiet))};
}

CheckedSample recomputed(const Setup& setup, std::size_t sample, const std::atomic<bool>& stop) {
  FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.project, store);
  const OrderlyEnd orderly;
  return {setup.config.name, recompute_sample(setup.project, plan, store, sample, stop)};
}

ExitStatus run_verify(Arguments arguments, const VerifyOptions& options, ReportFormat format,
                      const std::atomic<bool>& stop) {
  if (options.configs.empty() && arguments.cache.empty())
    throw ConfigError("name a configuration, or a cache with --cache DIR");
  VerifyReport report;
  const auto verify = [&](const fs::path& cache) {
    add(format, arguments.quiet, verified(cache, arguments.quiet, stop), report.caches);
  };
  std::set<fs::path> seen;
  if (options.configs.empty()) verify(arguments.cache);
  for (const std::string& config : options.configs) {
    arguments.config = config;
    const Setup setup(arguments, {}, Pictures::cached);
    if (seen.insert(fs::weakly_canonical(setup.cache)).second) verify(setup.cache);
    if (options.deep)
      add(format, arguments.quiet, recomputed(setup, static_cast<std::size_t>(options.sample), stop),
          report.samples);
  }
  report.interrupted = stop;
  print_report(format, "verify", json_of(report), "");
  if (report.interrupted) return interrupted_status(arguments);
  const auto sound = [](const auto& checked) { return checked.found.faults.empty(); };
  return std::ranges::all_of(report.caches, sound) && std::ranges::all_of(report.samples, sound)
             ? kAllDone
             : kSomeFailed;
}

}  // namespace

Subcommand verify_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<VerifyOptions>();
  const FormatWord format = default_format();
  Parameters parameters = maintaining_parameters(
      arguments, {of_path({"CONFIG", &options->configs, "configuration files, or none with --cache"}),
                  {"--deep", &options->deep, "also compute a sample of the cached jobs again, and compare"},
                  {"--sample", &options->sample, "how many (default: 20)"},
                  format_parameter(format)});
  parameters = needing(std::move(parameters), "CONFIG", {"--data", "--deep"});
  parameters = needing(std::move(parameters), "--deep", {"--sample", "--items", "--split", "--reference"});
  return {"verify", "read every artefact of a cache and name each bad one; changes nothing",
          std::move(parameters), [&arguments, options, format](const std::atomic<bool>& stop) {
            return run_verify(arguments, *options, format_of(format), stop);
          }};
}

}  // namespace salbench
