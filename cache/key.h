// Everything that an artefact is a function of. Never in it: time stamps, paths, thread counts, source text.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cache/digest.h"

namespace salbench {

struct Recipe {
  std::string stage;
  std::int32_t stage_version = 0;
  std::string options;  // canonical text, one `key: value` a line
  std::string seed;     // "seed/item" where random numbers are used; else empty
  std::vector<std::pair<std::string, Digest>> inputs;  // name and content digest, in the order of the catalog
};

Digest key_of(const Recipe& recipe);

}  // namespace salbench
