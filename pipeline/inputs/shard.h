// SPDX-License-Identifier: GPL-3.0-or-later
// A share of a data set, by which several machines or processes divide the work without communicating.
#pragma once

#include <string>
#include <vector>

#include "io/shapes/dataset.h"

namespace salbench {

struct Shard {
  int index = 1, count = 1;  // 1 <= index <= count

  std::string text() const;  // "2/4"
};

// Parses "2/4"; throws ConfigError for anything else.
Shard parse_shard(const std::string& text);

// Items of one share, in their order. Shares are disjoint and complete, with about equally many bytes of
// meshes each: items are assigned by decreasing size to the share with the fewest bytes.
std::vector<Item> share_of(std::vector<Item> items, const Shard& shard);

}  // namespace salbench
