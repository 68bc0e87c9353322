// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that an artefact depends on; no time stamps, paths, thread counts or source text.
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
  std::string seed;                                    // "seed/item" if random numbers are used; else empty
  std::vector<std::pair<std::string, Digest>> inputs;  // name and content digest, in the order of the rules
};

Digest key_of(const Recipe& recipe);

// The inputs as artefacts and exports state them: one "name: digest" per line. A line break within a name is
// followed by '/', with which no other line begins.
std::string inputs_text(const Recipe& recipe);

}  // namespace salbench
