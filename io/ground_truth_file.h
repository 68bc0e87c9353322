// SPDX-License-Identifier: GPL-3.0-or-later
// Reads what people marked on a mesh. [chen2012]
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "io/dataset.h"
#include "stages/core/types.h"

namespace salbench {

// All throw InputError, one line "PATH:LINE: what is wrong". Blank lines are skipped.

ScalarField parse_values(std::string_view text, std::string_view name);  // finite numbers, one per line

// The same, exactly n_vertices of them (.val).
ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices);

// 0-based vertex indices, one per line (.pid), in the file's order. A participant who marked nothing is real
// data.
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, std::size_t n_vertices);

// Ground truth of an item from the texts of its files: the saliency's first, if it has one, then the
// participants'. If no participant marked anything, there are no picks.
GroundTruth parse_ground_truth(const DatasetItem& item, std::span<const std::string_view> texts,
                               std::size_t n_vertices);

}  // namespace salbench
