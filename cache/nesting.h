// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is started by a function of another one over the same cache would wait for ever: for what the
// other has claimed, and gives up when the function returns.
#pragma once

#include <filesystem>
#include <memory>

#include <sys/types.h>

#include "cache/claim.h"

namespace salbench {

// The calling thread is about to carry out a function for a run, until the object is gone.
std::unique_ptr<Claim> enter_function(const std::filesystem::path& cache);

// True if this thread, or one that has started this process or one above it, is in such a function. False
// where the system does not tell.
bool is_inside_function(const std::filesystem::path& cache, pid_t thread);

}  // namespace salbench
