// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <fmt/format.h>

#include "cache/layout.h"
#include "pipeline/commands/commit.h"
#include "pipeline/commands/health.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

Json microseconds(const std::optional<double>& seconds) {
  return seconds ? Json(std::llround(*seconds * 1e6)) : Json();
}

std::string_view locks_text(const std::optional<bool>& locks) {
  if (!locks) return "untried";
  return *locks ? "hold" : "missing";
}

Json need_json(const std::optional<SpaceNeed>& need) {
  const auto number = [&](auto member) { return need ? Json((*need).*member) : Json(); };
  return {{"artefacts", number(&SpaceNeed::artefacts)},
          {"by_cache", number(&SpaceNeed::by_cache)},
          {"files", number(&SpaceNeed::files)},
          {"bytes", number(&SpaceNeed::bytes)}};
}

Json json_of(const Health& health) {
  const auto& [system, cores, memory, limits] = health.machine;
  return {
      {"program", {{"version", health.version}, {"commit", health.commit}}},
      {"system", system},
      {"cores",
       {{"online", cores.online},
        {"allowed", cores.allowed},
        {"limit_percent", std::llround(limits.cores * 100)},
        {"threads", health.threads}}},
      {"simd", health.simd},
      {"memory",
       {{"bytes", memory.total_bytes},
        {"available_bytes", memory.available_bytes},
        {"limit_bytes", limits.memory_bytes}}},
      {"cache",
       {{"folder", health.cache},
        {"exists", health.is_cache},
        {"file_system", health.disk.mount.type},
        {"mounted_at", health.disk.mount.point},
        {"mount_options", health.disk.mount.options},
        {"writable", health.disk.writable},
        {"fsync_us", microseconds(health.trial.sync_seconds)},
        {"rename_us", microseconds(health.trial.rename_seconds)},
        {"locks", locks_text(health.trial.locks)},
        {"free_bytes", health.disk.free.bytes},
        {"free_files", health.disk.free.files}}},
      {"need", need_json(health.need)},
      {"temporary", {{"folder", health.temporary}, {"free_bytes", health.temporary_free.bytes}}},
      {"libraries",
       list_of(health.libraries,
               [](const Library& library) {
                 return Json{{"name", library.name}, {"built", library.built}, {"loaded", library.loaded}};
               })},
      {"lines", list_of(lines_of(health), [](const HealthLine& line) {
         return Json{{"topic", line.topic}, {"what", line.text}, {"advice", line.advice}};
       })}};
}

std::string text_of(const Health& health) {
  std::string text;
  for (const auto& [topic, what, advice] : lines_of(health))
    text += fmt::format("{:<10} {}{}{}\n", topic, what, advice.empty() ? "" : "; ADVICE: ", advice);
  return text;
}

// The cache and what a run of the configuration would add to it; without a configuration the cache alone.
void look_at_cache(const Arguments& arguments, Health& health) {
  if (arguments.config.empty()) {
    health.cache = arguments.cache.empty() ? "salbench-cache" : arguments.cache;
    const FolderStore store(health.cache, Access::on_demand);  // throws if it is none that a run could use
  } else {
    const Setup setup(arguments);
    health.cache = setup.cache;
    const FolderStore store(setup.cache, Access::read_only);
    health.need =
        space_needed(setup.config, setup.inputs, setup.project, make_plan(setup.project, store), store);
  }
  health.is_cache = is_cache(health.cache);
  health.disk = disk_facts(health.cache);
  const fs::path scratch = health.cache / kScratchFolder;
  std::error_code error;
  health.trial = health.is_cache && fs::is_directory(scratch, error)
                     ? try_disk(scratch)
                     : try_disk_without_names(health.disk.folder);
}

ExitStatus examine(const Arguments& arguments, ReportFormat format) {
  Health health;
  health.version = SALBENCH_VERSION;
  health.commit = commit();
  health.machine = this_machine();
  health.threads = thread_count(arguments);
  health.simd = chi2_kernel::kernel().instructions;
  health.libraries = libraries();
  std::error_code error;
  health.temporary = fs::temp_directory_path(error);
  health.temporary_free = free_space(existing_folder(health.temporary));
  look_at_cache(arguments, health);
  print_report(format, "doctor", json_of(health), text_of(health));
  return can_run(health) ? kAllDone : kUnusableStorage;
}

}  // namespace

Subcommand doctor_subcommand(Arguments& arguments) {
  const FormatWord format = default_format();
  Parameters parameters = needing(
      planning_parameters(
          arguments, {shard_parameter(arguments), threads_parameter(arguments), format_parameter(format)}),
      "CONFIG", {"--data", "--items", "--split", "--reference", "--shard"});
  parameters.front().required = false;  // the configuration
  parameters.front().help += ": what its run needs, if it is given";
  return {"doctor",
          "tell in ten lines what this machine and the disk of the cache have, and what to do about it",
          parameters,
          [&arguments, format](const std::atomic<bool>&) { return examine(arguments, format_of(format)); }};
}

}  // namespace salbench
