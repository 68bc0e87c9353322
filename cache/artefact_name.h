// SPDX-License-Identifier: GPL-3.0-or-later
// The file name of an artefact: a label for people, then what the index needs to know.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cache/digest.h"

namespace salbench {

struct ArtefactName {
  std::string item;  // sanitised label
  Digest key;
  Digest content;
  std::uint64_t checksum = 0;  // of the file's bytes
  std::uint64_t size = 0;      // of the file, bytes

  std::string text() const;
};

std::optional<ArtefactName> parse_artefact_name(std::string_view file_name);

// Letters, digits, '-' and '_' stay; everything else becomes '_'; at most 60 bytes.
std::string item_label(std::string_view item);

}  // namespace salbench
