// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions, by who has to act. Any other exception is a defect of the program.
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace salbench {

// Spelling of options in messages: command-line options, or arguments of functions. Set once, at the start.
inline bool options_are_arguments = false;

// "--items 1-20" or "items='1-20'"; without a value "--items" or "`items`".
inline std::string as_option(const std::string& name, const std::string& value = {}) {
  if (!options_are_arguments) return "--" + name + (value.empty() ? "" : " " + value);
  return value.empty() ? "`" + name + "`" : name + "='" + value + "'";
}

// Removes zero bytes, at which what() would end: texts from a file, a command or a function may contain them.
struct Error : std::runtime_error {
  explicit Error(std::string message) : std::runtime_error(without_zeros(std::move(message))) {}

 private:
  static std::string without_zeros(std::string text) {
    for (std::size_t at = 0; (at = text.find('\0', at)) != std::string::npos;) text.replace(at, 1, "\\0");
    return text;
  }
};

// An item's data is unusable: the message names file and line, or the item, and a remedy. Only the item, or
// one stage of it, fails.
struct InputError : Error {
  using Error::Error;
};

// A shape or values on it are unusable as a whole; the message names no file. The only InputError of the
// stages, which know no files; callers may add the file.
struct ShapeError : InputError {
  using InputError::InputError;
};

// A file is unusable: the message begins with its name.
struct FileError : InputError {
  FileError(const std::string& file, const std::string& what_is_wrong)
      : InputError(file + ": " + what_is_wrong) {}
};

// The system does not provide a file (permissions, disk failure, no memory): its content is unknown.
struct UnreadableError : FileError {
  using FileError::FileError;
};

// Arguments or configuration are unusable (exit status 2).
struct ConfigError : Error {
  using Error::Error;
};

// An unknown name, such as that of an item or a split.
struct UnknownNameError : ConfigError {
  using ConfigError::ConfigError;
};

// Error in a configuration file: the message begins with file and line, `what_is_wrong` does not.
struct SectionError : ConfigError {
  SectionError(const std::string& where, std::string wrong)
      : ConfigError(where + ": " + wrong), what_is_wrong(std::move(wrong)) {}
  std::string what_is_wrong;  // "fpfh.radius must be > 0, not -1"
};

// An option has an invalid value. Its reader adds where it was set.
struct OptionError : ConfigError {
  OptionError(std::string option_key, std::string wrong)
      : ConfigError(option_key + " " + wrong), key(std::move(option_key)), what_is_wrong(std::move(wrong)) {}
  std::string key;            // the field's name within its options, "radius"
  std::string what_is_wrong;  // "must be > 0, not -1"
};

// The cache or output folder is unusable (exit status 3).
struct StorageError : Error {
  using Error::Error;
};

// The program was asked to stop while a command was running, whose result is therefore unknown.
struct Interrupted : Error {
  using Error::Error;
};

// Address for reports of defects; empty until there is one, and messages name none.
inline constexpr const char* kReportAt = "";

inline std::string a_defect() {
  const std::string at = kReportAt;
  return "a defect of salbench" + (at.empty() ? at : ", please report it at " + at);
}

// Message for any other exception (exit status 70). To be called in a catch block.
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
