// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/artefact_name.h"

#include <array>
#include <cctype>

#include <fmt/format.h>

namespace salbench {

constexpr std::string_view kSuffix = ".h5";

std::string ArtefactName::text() const {
  return fmt::format("{}.{}.{}.{:016x}.{:x}{}", item, key.hex(), content.hex(), checksum, size, kSuffix);
}

std::optional<ArtefactName> parse_artefact_name(std::string_view file_name) {
  if (!file_name.ends_with(kSuffix)) return {};
  file_name.remove_suffix(kSuffix.size());
  std::array<std::string_view, 5> parts;  // item, key, content, checksum, size
  for (std::size_t i = parts.size(); i-- > 1;) {
    const std::size_t dot = file_name.rfind('.');
    if (dot == std::string_view::npos) return {};
    parts[i] = file_name.substr(dot + 1);
    file_name = file_name.substr(0, dot);
  }
  const auto key = digest_from_hex(parts[1]);
  const auto content = digest_from_hex(parts[2]);
  const auto sum = number_from_hex(parts[3]);
  const auto size = number_from_hex(parts[4]);
  if (!key || !content || !sum || !size) return {};
  return ArtefactName{std::string(file_name), *key, *content, *sum, *size};
}

std::string item_label(std::string_view item) {
  std::string label(item.substr(0, 60));
  for (char& c : label)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return label;
}

}  // namespace salbench
