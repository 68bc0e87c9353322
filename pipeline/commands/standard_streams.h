// SPDX-License-Identifier: GPL-3.0-or-later
// Standard input, output and errors, which whoever starts the program may have closed, and which may be full.
#pragma once

#include <functional>

namespace salbench {

// Opens the closed ones, so that no file of the program gets their number and is written into. For the start
// of main. A standard output that was closed can then not be written to, which print_all reports.
void open_standard_streams();

// Calls `work`, which prints with fmt::print, flushes standard output and returns what `work` returns. Throws
// StorageError if something of it could not be written.
int print_all(const std::function<int()>& work);

}  // namespace salbench
