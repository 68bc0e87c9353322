// SPDX-License-Identifier: GPL-3.0-or-later
// A share of a data set, so that several machines or processes divide the work without speaking to each
// other.
#pragma once

#include <string>
#include <vector>

#include "io/shapes/dataset.h"

namespace salbench {

struct Shard {
  int index = 1, count = 1;  // 1 <= index <= count

  std::string text() const;  // "2/4"
};

// "2/4"; throws ConfigError for anything else.
Shard parse_shard(const std::string& text);

// The items of one share, in their order. The shares are disjoint, together they are all, and each has about
// as many bytes of meshes: the largest first, to the share that has least.
std::vector<Item> share_of(std::vector<Item> items, const Shard& shard);

}  // namespace salbench
