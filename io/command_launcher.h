// SPDX-License-Identifier: GPL-3.0-or-later
// The processes between the program and its commands (the program's side is kept_command.h):
//
//   program ── launcher ─┬─ keeper ── sh ── ...
//                        └─ keeper ── sh ── ...
//
// A keeper adopts whatever its command leaves behind, and ends when all of it has ended. The launcher starts
// keepers; it is a copy of the program from the time when that was small, because a copy that lives as long
// as a command makes the program pay for each page that it writes. When the program ends, however it does,
// both see the end of their sockets, end every process below them, and the launcher removes abandoned scratch
// folders.
#pragma once

#include <cstdint>
#include <type_traits>

namespace salbench {

// Requests to the launcher, on a SOCK_SEQPACKET socket: these descriptors, and one byte. Without an input the
// command has nothing to read.
enum RequestedFile { kControl, kOutput, kErrors, kInput, kRequestedFiles };

// On the control socket, a stream, the keeper first reads the lengths of two texts (two std::size_t), and
// these: the folder and the command. Every further byte asks it to send SIGTERM to all of the command's
// processes; the end of the stream, to kill them. When none is left, it writes this, unless it was asked to
// kill them, and closes its end.
struct KeptEnd {
  std::int32_t error = 0;   // errno if there was no process for it; 0: it ran
  std::int32_t status = 0;  // of the shell, as of waitpid
};
static_assert(std::is_trivially_copyable_v<KeptEnd>);

// The life of the launcher, in a child process. Every command gets SIGTERM once `ending` polls as readable.
[[noreturn]] void run_launcher(int requests, int ending);

}  // namespace salbench
