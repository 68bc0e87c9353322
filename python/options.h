// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the stages as keyword arguments: what a configuration calls them, with its defaults and its
// checks.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pybind11/pybind11.h>

#include "pipeline/config/section.h"
#include "stages/core/options.h"

namespace salbench::python {

// `key: value` for each keyword, as a configuration has them. Throws TypeError for a keyword that is not
// among `known`.
Section section_of(const pybind11::dict& keywords, const std::string& function,
                   const std::vector<std::string_view>& known);
// ValueError from what a section says of its file, which there is none of.
[[noreturn]] void rethrow(const SectionError& error, const std::string& function);

template <class Options>
Options options_from(const pybind11::dict& keywords, const std::string& function, Options options = {}) {
  if (keywords.size() == 0) return options;
  std::vector<std::string_view> known;
  Options::fields(options,
                  [&](std::string_view key, const auto&, const OptionHelp&) { known.push_back(key); });
  const Section section = section_of(keywords, function, known);
  try {
    section.read(options);
  } catch (const SectionError& error) {
    rethrow(error, function);
  }
  return options;
}

// (name, default, note) of each option, as texts.
pybind11::list described(const std::vector<OptionRow>& options);
template <class Options>
pybind11::list described(const Options& options = {}) {
  return described(option_rows(options));
}

}  // namespace salbench::python
