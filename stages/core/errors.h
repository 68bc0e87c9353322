// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions, by who has to act. Everything else that is thrown is a defect of the program.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace salbench {

// How messages write options: as commands take them, or as arguments of functions. Set once, before anything
// else is done.
inline bool options_are_arguments = false;

// "--items 1-20" or "items='1-20'"; without a value "--items" or "`items`".
inline std::string as_option(const std::string& name, const std::string& value = {}) {
  if (!options_are_arguments) return "--" + name + (value.empty() ? "" : " " + value);
  return value.empty() ? "`" + name + "`" : name + "='" + value + "'";
}

// Its message is whole for whoever reads what(), which a zero byte ends: what a file, a command or a function
// said may have one.
struct Error : std::runtime_error {
  explicit Error(std::string message) : std::runtime_error(without_zeros(std::move(message))) {}

 private:
  static std::string without_zeros(std::string text) {
    for (std::size_t at = 0; (at = text.find('\0', at)) != std::string::npos;) text.replace(at, 1, "\\0");
    return text;
  }
};

// An item's data cannot be used: the message names file and line, or the item, and what to do.
// The item (or one stage of it) fails; the others go on.
struct InputError : Error {
  using Error::Error;
};

// A shape, or values on it, cannot be used as a whole: the message names no file. Stages, which know none,
// throw no other InputError; whoever knows the file may add it.
struct ShapeError : InputError {
  using InputError::InputError;
};

// A file cannot be used: the message begins with its name.
struct FileError : InputError {
  FileError(const std::string& file, const std::string& what_is_wrong)
      : InputError(file + ": " + what_is_wrong) {}
};

// The system does not hand a file over (permissions, a disk that fails, no memory): nothing is known of what
// it holds.
struct UnreadableError : FileError {
  using FileError::FileError;
};

// Arguments or configuration cannot be used (exit status 2).
struct ConfigError : Error {
  using Error::Error;
};

// A name, such as that of an item or a split, is not among those that there are.
struct UnknownNameError : ConfigError {
  using ConfigError::ConfigError;
};

// A configuration file says what cannot be used: the message begins with the file and line, which
// `what_is_wrong` is without.
struct SectionError : ConfigError {
  SectionError(const std::string& where, std::string wrong)
      : ConfigError(where + ": " + wrong), what_is_wrong(std::move(wrong)) {}
  std::string what_is_wrong;  // "fpfh.radius must be > 0, not -1"
};

// An option has an invalid value. The reader of the option adds where it was set.
struct OptionError : ConfigError {
  OptionError(std::string option_key, std::string wrong)
      : ConfigError(option_key + " " + wrong), key(std::move(option_key)), what_is_wrong(std::move(wrong)) {}
  std::string key;            // the field's name within its options, "radius"
  std::string what_is_wrong;  // "must be > 0, not -1"
};

// The cache or output folder cannot be used (exit status 3).
struct StorageError : Error {
  using Error::Error;
};

// The program was asked to end while a command was at work: nothing is known about the command.
struct Interrupted : Error {
  using Error::Error;
};

// Address for reports of defects; empty until there is one, and messages name none.
inline constexpr const char* kReportAt = "";

inline std::string a_defect() {
  const std::string at = kReportAt;
  return "a defect of salbench" + (at.empty() ? at : ", please report it at " + at);
}

// The message for any other exception (exit status 70). Call it inside a catch block.
inline std::string current_defect() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return "out of memory; use fewer " + as_option("threads") + ", or leave large items out with " +
           as_option("items");
  } catch (const std::exception& error) {
    return a_defect() + ": " + error.what();
  } catch (...) {
    return a_defect() + ": an unknown exception";
  }
}

}  // namespace salbench
