// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/key.h"

#include <fmt/format.h>

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

std::string inputs_text(const Recipe& recipe) {
  std::string text;
  for (const auto& [name, digest] : recipe.inputs) {
    for (const char c : name) {
      text += c;
      if (c == '\n') text += '/';  // no item name contains '/', as names come from files
    }
    text += fmt::format(": {}\n", digest.hex());
  }
  return text;
}

}  // namespace salbench
