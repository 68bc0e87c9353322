// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/health.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace salbench {
namespace {

constexpr std::uint64_t kLittleMemory = 500'000'000;     // a run over the meshes of SHREC'07 takes 230 MB
constexpr std::uint64_t kLittleTemporary = 100'000'000;  // for what commands of users are given and write
constexpr double kSlowRename_s = 0.01;                   // a shape has some twenty artefacts

std::string milliseconds(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.2f} ms", *seconds * 1e3) : "not measured";
}

HealthLine cores_line(const Health& health) {
  const auto& [online, allowed] = health.machine.cores;
  const double limit = health.machine.limits.cores;
  HealthLine line{"cores", fmt::format("{} of {} may be used", allowed, online), {}};
  if (limit > 0) line.text += fmt::format(", the control group grants {:.3g}", limit);
  line.text += fmt::format("; a run takes {} threads", health.threads);
  if (limit > 0 && health.threads > std::ceil(limit))
    line.advice = fmt::format("run with --threads {}: more are held up", std::ceil(limit));
  return line;
}

HealthLine memory_line(const Health& health) {
  const Memory& memory = health.machine.memory;
  const std::uint64_t limit = health.machine.limits.memory_bytes;
  HealthLine line{
      "memory",
      fmt::format("{}, {} available", bytes_text(memory.total_bytes), bytes_text(memory.available_bytes)),
      {}};
  if (limit > 0) line.text += fmt::format(", the control group grants {}", bytes_text(limit));
  const std::uint64_t usable = limit > 0 ? std::min(limit, memory.available_bytes) : memory.available_bytes;
  if (usable < kLittleMemory) line.advice = "close other programs, or use fewer --threads";
  return line;
}

HealthLine cache_line(const Health& health) {
  HealthLine line{"cache",
                  fmt::format("{}: {}, {} mounted at {}", health.cache.string(),
                              health.is_cache ? "a cache" : "no cache yet", health.disk.mount.type,
                              health.disk.mount.point),
                  {}};
  if (!health.disk.writable)
    line.advice = fmt::format(
        "{} cannot be written to: choose another folder with --cache, unless the cache lacks nothing",
        health.disk.folder.string());
  return line;
}

HealthLine speed_line(const Health& health) {
  const auto& [sync, rename, locks] = health.trial;
  HealthLine line{"disk", fmt::format("fsync {}, rename {}", milliseconds(sync), milliseconds(rename)), {}};
  if (rename && *rename > kSlowRename_s)
    line.advice = "each artefact is renamed once: a local disk takes less time (--cache)";
  return line;
}

std::string basis_of(const SpaceNeed& need) {
  return fmt::format(
      "{} artefacts, of which {} are estimated by those of the cache, {} by the sizes of shape files",
      need.artefacts, need.by_cache, need.artefacts - need.by_cache);
}

HealthLine space_line(const Health& health) {
  const FreeSpace& free = health.disk.free;
  HealthLine line{
      "space", free.bytes < FreeSpace::kNoLimit ? bytes_text(free.bytes) : "not known how much", {}};
  if (free.files < FreeSpace::kNoLimit) line.text += fmt::format(" and {} files", free.files);
  line.text += " free";
  if (!health.need) {
    line.text += "; with a CONFIG, what its run needs";
  } else if (health.need->artefacts == 0) {
    line.text += "; a run has nothing to compute";
  } else {
    line.text += fmt::format("; the run needs {}: {}", text_of(*health.need), basis_of(*health.need));
    line.advice = shortage(*health.need, free);
  }
  return line;
}

HealthLine sharing_line(const Health& health) {
  HealthLine line{"sharing", {}, {}};
  if (!health.trial.locks) {
    line.text = "locks were not tried";
  } else if (!*health.trial.locks) {
    line.text = "no locks on this file system: processes that share the cache repeat each other's work";
    line.advice = "run one at a time, or give each its --shard; results are right either way";
  } else if (locks_stay_here(health.disk.mount)) {
    line.text = "locks hold between processes of this machine, and not between machines";
    line.advice = "on several machines give each its --shard, or mount the disk with locks of its server";
  } else {
    line.text = "locks hold: several processes may share the cache";
    if (is_network(health.disk.mount)) line.text += "; between machines they were not tried";
  }
  return line;
}

HealthLine temporary_line(const Health& health) {
  HealthLine line{"temporary",
                  fmt::format("{}: {} free, for models that are commands of yours", health.temporary.string(),
                              bytes_text(health.temporary_free.bytes)),
                  {}};
  if (health.temporary_free.bytes < kLittleTemporary)
    line.advice = "free some space, or name another folder in TMPDIR";
  return line;
}

HealthLine libraries_line(const Health& health) {
  HealthLine line{"libraries", {}, {}};
  for (const auto& [name, built, loaded] : health.libraries) {
    line.text += fmt::format("{}{} {}", line.text.empty() ? "" : ", ", name, loaded.value_or(built));
    if (loaded && !loaded->starts_with(built)) line.text += fmt::format(" (built with {})", built);
  }
  return line;
}

}  // namespace

std::vector<HealthLine> lines_of(const Health& health) {
  constexpr std::size_t kDigits = 40, kShown = 12;  // of a commit
  const std::string commit =
      health.commit.size() < kDigits
          ? ""
          : fmt::format(", commit {}{}", health.commit.substr(0, kShown), health.commit.substr(kDigits));
  return {{"program", fmt::format("salbench {}{}, instructions {}", health.version, commit, health.simd), {}},
          {"system", health.machine.system, {}},
          cores_line(health),
          memory_line(health),
          cache_line(health),
          speed_line(health),
          space_line(health),
          sharing_line(health),
          temporary_line(health),
          libraries_line(health)};
}

bool can_run(const Health& health) {
  return health.disk.writable || (health.need && health.need->artefacts == 0);
}

}  // namespace salbench
