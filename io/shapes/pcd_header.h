// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a PCD file: what the body consists of.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/shapes/text_scanner.h"
#include "stages/core/types.h"

namespace salbench::pcd {

struct Field {
  std::string name;
  std::int64_t size = 4;   // bytes of one value: 1, 2, 4, 8
  char type = 'F';         // I: signed, U: unsigned, F: floating point
  std::int64_t count = 1;  // values per point; 0: takes no bytes, as drivers of lidars write it

  std::int64_t bytes() const { return size * count; }
};

enum class Data { ascii, binary, binary_compressed };

struct Header {
  std::vector<Field> fields;
  std::int64_t points = 0;
  std::int64_t height = 1;  // above 1: organised, the image of one camera
  std::optional<Vec3> viewpoint;
  Data data = Data::ascii;

  const Field* find(std::string_view field) const;
  std::int64_t bytes_per_point() const;
};

// Reads up to and including the line DATA. Throws InputError for what the rest of the file cannot follow.
Header read_header(TextScanner& in);

}  // namespace salbench::pcd
