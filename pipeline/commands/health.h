// SPDX-License-Identifier: GPL-3.0-or-later
// What `salbench doctor` has found out, and what it makes of it: a line per topic, with what to do where
// something is wrong. Pure: tests make up machines.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/disk.h"
#include "io/machine.h"
#include "pipeline/commands/libraries.h"
#include "pipeline/results/space.h"

namespace salbench {

struct Health {
  std::string version, commit;
  Machine machine;
  int threads = 1;  // that a run takes
  std::string simd;
  std::filesystem::path cache;
  bool is_cache = false;
  DiskFacts disk;
  DiskTrial trial;
  std::filesystem::path temporary;
  FreeSpace temporary_free;
  std::vector<Library> libraries;
  std::optional<SpaceNeed> need;  // of a configuration, if one is given
};

struct HealthLine {
  std::string topic, text;
  std::string advice;  // empty: nothing is wrong
};
std::vector<HealthLine> lines_of(const Health& health);

// False if the cache cannot be written to, unless there is nothing to compute.
bool can_run(const Health& health);

}  // namespace salbench
