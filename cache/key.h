// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that determines an artefact; excludes time stamps, paths, thread counts and source text.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/digest.h"

namespace salbench {

struct Recipe {
  std::string stage;
  std::int32_t stage_version = 0;
  std::string options;                                 // canonical text, one `key: value` per line
  std::string seed;                                    // "seed/item" if random numbers are used, else empty
  std::vector<std::pair<std::string, Digest>> inputs;  // name and content digest, in the order of the rules
};

Digest key_of(const Recipe& recipe);

// Inputs as artefacts and exports list them: one "name: digest" per line. A line break within a name is
// followed by '/', which begins no other line.
std::string inputs_text(const Recipe& recipe);

}  // namespace salbench
