// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/key.h"

namespace salbench {

Digest key_of(const Recipe& recipe) {
  Hasher hasher;
  hasher.add(recipe.stage);
  hasher.add(static_cast<std::uint64_t>(recipe.stage_version));
  hasher.add(recipe.options);
  hasher.add(recipe.seed);
  hasher.add(std::uint64_t{recipe.inputs.size()});
  for (const auto& [name, digest] : recipe.inputs) {
    hasher.add(name);
    hasher.add(digest);
  }
  return hasher.digest();
}

}  // namespace salbench
