// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/key.h"

#include <algorithm>

#include <fmt/format.h>

namespace salbench {
namespace {

constexpr std::string_view kBetween = ": ";  // the digest comes last: a name may hold it, too
constexpr char kContinued = '/';             // in no name of an item, as that is a name of a file

}  // namespace

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
      if (c == '\n') text += kContinued;
    }
    text += fmt::format("{}{}\n", kBetween, digest.hex());
  }
  return text;
}

std::optional<std::vector<std::pair<std::string, Digest>>> inputs_from_text(std::string_view text) {
  std::vector<std::pair<std::string, Digest>> inputs;
  while (!text.empty()) {
    std::string line;
    for (bool continued = true; continued;) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      line += text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      continued = text.starts_with(kContinued);
      if (continued) {
        line += '\n';
        text.remove_prefix(1);
      }
    }
    const std::size_t at = line.rfind(kBetween);
    if (at == std::string::npos) return {};
    const auto digest = digest_from_hex(std::string_view(line).substr(at + kBetween.size()));
    if (!digest) return {};
    inputs.emplace_back(line.substr(0, at), *digest);
  }
  return inputs;
}

}  // namespace salbench
