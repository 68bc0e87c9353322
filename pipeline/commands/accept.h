// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `accept`: takes results of a stage's earlier versions for those of its present one.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "cache/folder_store.h"
#include "pipeline/plan/plan.h"

namespace salbench {

// Marks results of earlier versions of a stage as valid for its present one: where options, seed and inputs
// are the same, the newest such result is stored under the new key, with `accepted_from_version` among its
// attributes. What depends on the stage stays valid, since the content is the same.
struct Accepted {
  std::size_t accepted = 0;
  std::size_t valid = 0;    // were there already
  std::size_t missing = 0;  // no earlier version has a result for these options and inputs
  std::size_t waiting = 0;  // what they read is not there
};
// Throws ConfigError for a stage that does not exist, and StorageError.
Accepted accept_stage(const Context& context, const std::string& stage, FolderStore& store,
                      const std::atomic<bool>& stop);

}  // namespace salbench
