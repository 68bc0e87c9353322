// SPDX-License-Identifier: GPL-3.0-or-later
// The processes that this one has started, those that they have started, and so on. For a process that adopts
// orphans (PR_SET_CHILD_SUBREAPER): whatever leaves its group, its session or its parent is still found.
#pragma once

namespace salbench {

void signal_descendants(int signal);

// Kills and reaps until none is left. Gives up after ten seconds on those that the system does not end: they
// hang in a device, or belong to somebody else.
void end_descendants();

}  // namespace salbench
