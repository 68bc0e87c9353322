// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the stages as keyword arguments, with the names, defaults and checks of a configuration.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "pipeline/config/section.h"
#include "stages/core/options.h"

namespace salbench::python {

// Section with `key: value` per keyword, as in a configuration. Throws TypeError for an unknown keyword.
Section section_of(const pybind11::dict& keywords, const std::string& function,
                   const std::vector<OptionRow>& options);
// Rethrows a section's error as a ValueError, without the file that it would name.
[[noreturn]] void rethrow(const SectionError& error, const std::string& function);
// (name, default, note) of each option, as text.
pybind11::list described(const std::vector<OptionRow>& options);

// Options that `read` returns for the keywords' section.
template <class Read>
auto read_keywords(const pybind11::dict& keywords, const std::string& function,
                   const std::vector<OptionRow>& options, const Read& read) {
  const Section section = section_of(keywords, function, options);
  try {
    return read(section);
  } catch (const SectionError& error) {
    rethrow(error, function);
  }
}

// Defines a module function from one with options as its last parameter, passed as a dict and described in
// the module's dict `options`. `called`: the public name, if different.
template <class Options, class Result, class... Arguments>
void define(pybind11::module_& module, const char* name, Result (*function)(const Options&, Arguments...),
            const char* called = nullptr) {
  const std::vector<OptionRow> rows = option_rows(Options());
  const std::string in_messages = called == nullptr ? name : called;
  module.def(name, [=](Arguments... arguments, const pybind11::dict& keywords) {
    return function(read_keywords(keywords, in_messages, rows,
                                  [](const Section& section) {
                                    Options options;
                                    section.read(options);
                                    return options;
                                  }),
                    std::move(arguments)...);
  });
  module.attr("options")[name] = described(rows);
}

}  // namespace salbench::python
