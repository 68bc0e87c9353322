// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the stages as keyword arguments: what a configuration calls them, with its defaults and its
// checks.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "pipeline/config/section.h"
#include "stages/core/options.h"

namespace salbench::python {

// `key: value` for each keyword, as a configuration has them. Throws TypeError for a keyword that is none of
// the options.
Section section_of(const pybind11::dict& keywords, const std::string& function,
                   const std::vector<OptionRow>& options);
// ValueError from what a section says of its file, which there is none of.
[[noreturn]] void rethrow(const SectionError& error, const std::string& function);
// (name, default, note) of each option, as texts.
pybind11::list described(const std::vector<OptionRow>& options);

// What `read` makes of the section.
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

// A function of the module from one that takes options: these come last, as a dict, and the module's dict
// `options` describes them. `called`: by users, where that is another name.
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
