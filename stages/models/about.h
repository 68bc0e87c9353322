// SPDX-License-Identifier: GPL-3.0-or-later
// Description of a model for docstrings, tables and pages, and its part in a benchmark.
#pragma once

#include <string_view>

namespace salbench {

struct ModelAbout {
  std::string_view name;  // full name
  std::string_view authors = {}, year = {}, link = {};
  std::string_view key = {};     // in docs/bibliography.bib
  std::string_view values = {};  // meaning and range of the map, appended to the name
  bool by_default = false;       // included if a configuration names no models: the paper's models
  // People or chance: reference for models, not ranked itself.
  bool is_reference = false;
  bool is_floor = false;  // trivial baseline; the name `floors` stands for all of them
};

}  // namespace salbench
