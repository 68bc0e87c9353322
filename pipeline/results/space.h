// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan will take of the cache's disk, before anything is computed.
//
// A file that holds a mesh has at most one vertex per kMeshFileBytes, and of a cloud one point per
// kCloudFileBytes: no usual format needs less. A scan has as many points as rays meet a convex body of the
// mesh's area, seen from all sides; a concave one hides some. Each kind of result takes its bytes per point,
// and where artefacts of the same rule are in the cache, their sizes correct that.
#pragma once

#include <cstdint>
#include <string>

#include "cache/folder_store.h"
#include "io/disk.h"
#include "pipeline/engine/plan.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/rules/config.h"

namespace salbench {

struct SpaceNeed {
  std::size_t artefacts = 0;  // to compute or waiting: of these some may turn out unchanged
  std::size_t by_cache = 0;   // of these, those of rules that the cache has artefacts of
  std::uint64_t files = 0;    // segments, and folders for them
  std::uint64_t bytes = 0;    // of disk
};

// Takes no time where there is nothing to do.
SpaceNeed space_needed(const Config& config, const Inputs& inputs, const Project& project, const Plan& plan,
                       const FolderStore& store);

// Points of a scan on average over all directions, of a convex body; an upper estimate of others.
double points_of_scan(const ScanOptions& options);

// "about 5.1 GB in 7000 files"
std::string need_text(const SpaceNeed& need);

// "the run needs about 5.1 GB in 7000 files, and 2.0 GB are free: ..."; empty if it fits.
std::string shortage(const SpaceNeed& need, const FreeSpace& free);

std::string bytes_text(std::uint64_t bytes);  // "5.1 GB"

}  // namespace salbench
