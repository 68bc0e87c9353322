// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on standard error: a bar on a terminal, a plain line now and then elsewhere.
#pragma once

#include <memory>

#include "stages/core/progress.h"

namespace salbench {

std::unique_ptr<Progress> terminal_progress();
std::unique_ptr<Progress> progress_of(bool quiet);  // of a command: none if it is to be quiet

}  // namespace salbench
