// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings of the stages as records of Python's logging, logger "salbench". Threads of a stage have no
// interpreter lock and must not wait for it, least of all while Python shuts down: their messages are stored,
// and delivered by the calling Python thread when its call returns.
#pragma once

namespace salbench::python {

void keep_log();     // replaces logging to standard error; prints nothing
void deliver_log();  // needs the interpreter's lock; never throws

// Delivers stored messages on destruction; the interpreter's lock must be held.
struct LogDelivery {
  LogDelivery() = default;
  LogDelivery(const LogDelivery&) = delete;
  LogDelivery& operator=(const LogDelivery&) = delete;
  ~LogDelivery() { deliver_log(); }
};

}  // namespace salbench::python
