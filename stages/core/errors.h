// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions, by who has to act. Everything else that is thrown is a defect of the program.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace salbench {

// An item's data cannot be used: the message names file and line, or the item, and what to do.
// The item (or one stage of it) fails; the others go on.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Arguments or configuration cannot be used (exit status 2).
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// An option has an invalid value. The reader of the option adds where it was set.
struct OptionError : ConfigError {
  OptionError(std::string option_key, std::string wrong)
      : ConfigError(option_key + " " + wrong), key(std::move(option_key)), what_is_wrong(std::move(wrong)) {}
  std::string key;            // the field's name within its options, "radius"
  std::string what_is_wrong;  // "must be > 0, not -1"
};

// The cache or output folder cannot be used (exit status 3).
struct StorageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The program was asked to end while a command was at work: nothing is known about the command.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The message for any other exception (exit status 70). Call it inside a catch block.
inline std::string current_defect() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "out of memory; use fewer --threads, or leave large items out with --items";
  } catch (const std::exception& error) {
    return std::string("a defect of salbench, please report it: ") + error.what();
  } catch (...) {
    return "a defect of salbench, please report it: an unknown exception";
  }
}

}  // namespace salbench
