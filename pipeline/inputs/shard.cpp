// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/shard.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>

#include <fmt/format.h>

#include "pipeline/config/option_text.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// A missing mesh still costs its entry in the list.
std::uint64_t weight_of(const Item& item) {
  std::error_code missing;
  const std::uintmax_t size = std::filesystem::file_size(item.file, missing);
  return missing ? 1 : size + 1;
}

}  // namespace

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(const std::string& text) {
  Shard shard;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos || !parse_option(text.substr(0, slash), shard.index) ||
      !parse_option(text.substr(slash + 1), shard.count) || shard.index < 1 || shard.index > shard.count)
    throw ConfigError(fmt::format("--shard {}: must be I/N with 1 <= I <= N, such as 2/4", text));
  return shard;
}

std::vector<Item> share_of(std::vector<Item> items, const Shard& shard) {
  std::vector<std::uint64_t> weights;
  for (const Item& item : items) weights.push_back(weight_of(item));
  std::vector<std::size_t> largest_first(items.size());
  std::iota(largest_first.begin(), largest_first.end(), std::size_t{0});
  std::ranges::stable_sort(largest_first,
                           [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });

  std::vector<std::uint64_t> loads(static_cast<std::size_t>(shard.count));
  const auto ours = loads.begin() + (shard.index - 1);
  std::vector<std::size_t> taken;
  for (const std::size_t item : largest_first) {
    const auto least = std::ranges::min_element(loads);
    *least += weights[item];
    if (least == ours) taken.push_back(item);
  }
  std::ranges::sort(taken);
  std::vector<Item> share;
  for (const std::size_t item : taken) share.push_back(std::move(items[item]));
  return share;
}

}  // namespace salbench
