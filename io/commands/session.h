// SPDX-License-Identifier: GPL-3.0-or-later
// The processes of a session: of a command, whatever groups its processes have made.
#pragma once

#include <sys/types.h>

namespace salbench {

// Sends the signal to all of them; true if any was alive.
bool signal_session(pid_t session, int signal);

// Kills until none is left. Gives up after ten seconds on those that the system does not end: they hang in a
// device, or belong to somebody else.
void kill_session(pid_t session);

// The life of the guard, in a child process: it is told, in decimal, of each session that is started (its
// number) and ended (minus its number), and when all are to get SIGTERM (kAskToEnd). Once nobody is there to
// tell it, it kills those that are left and removes abandoned scratch folders. A session of its own keeps it
// from the signals of a terminal.
inline constexpr pid_t kAskToEnd = 0;
[[noreturn]] void run_guard(int told);

}  // namespace salbench
