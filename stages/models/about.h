// SPDX-License-Identifier: GPL-3.0-or-later
// What there is to say of a model, for docstrings, tables and pages; and how it takes part in a benchmark.
#pragma once

#include <string_view>

namespace salbench {

struct ModelAbout {
  std::string_view name;  // in full
  std::string_view authors = {}, year = {}, link = {};
  std::string_view key = {};     // in docs/bibliography.bib
  std::string_view values = {};  // meaning and range of the map, behind the name
  bool by_default = false;       // runs if a configuration names no models: those of the paper
  // People or chance: what models are measured against, and no competitor in a ranking.
  bool is_reference = false;
  bool is_floor = false;  // uses nothing that a model should be praised for; `floors` names all of them
};

}  // namespace salbench
