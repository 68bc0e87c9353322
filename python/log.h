// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings of the stages as records of Python's logging, logger "salbench". Threads of a stage have no
// interpreter's lock and may not wait for it, least of all while Python shuts down: what they say is kept,
// and handed over by the thread of Python that called, when its call returns.
#pragma once

namespace salbench::python {

void keep_log();     // from now on, in place of the standard error; says nothing
void deliver_log();  // with the interpreter's lock; throws nothing

// Delivers what was said meanwhile: to be made while the interpreter's lock is held.
struct LogDelivery {
  LogDelivery() = default;
  LogDelivery(const LogDelivery&) = delete;
  LogDelivery& operator=(const LogDelivery&) = delete;
  ~LogDelivery() { deliver_log(); }
};

}  // namespace salbench::python
