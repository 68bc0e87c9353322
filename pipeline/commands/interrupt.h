// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C, SIGTERM and the SIGHUP of a terminal or a connection that goes. What is in the cache has its name
// or is not there, so that a command may end at any moment; only what would leave something half done in the
// user's folders, or throw running work away, is brought to an orderly end.
#pragma once

#include <atomic>
#include <string>

namespace salbench {

// Once, at the start. Outside of an OrderlyEnd the first signal ends the program at once with `last_words` on
// standard error and exit status 130.
void handle_interrupts(const std::string& last_words);

// While one lives, the first signal only sets the flag, and the second one ends the program.
class OrderlyEnd {
 public:
  OrderlyEnd();
  OrderlyEnd(const OrderlyEnd&) = delete;
  OrderlyEnd& operator=(const OrderlyEnd&) = delete;
  ~OrderlyEnd();
};

const std::atomic<bool>& interrupted();  // the flag

}  // namespace salbench
