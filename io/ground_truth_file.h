// Reads what people marked on a mesh. [chen2012]
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "io/dataset.h"
#include "stages/core/types.h"

namespace salbench {

// All throw InputError, one line "PATH:LINE: what is wrong". Blank lines are passed over.

// n_vertices finite numbers, one a line (.val).
ScalarField read_saliency(const std::filesystem::path& path, std::size_t n_vertices);
ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices);

// 0-based vertex indices, one a line (.pid), in the file's order. A participant who marked nothing is real
// data.
std::vector<std::int32_t> read_picks(const std::filesystem::path& path, std::size_t n_vertices);
std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, std::size_t n_vertices);

// Both of an item; empty where it has no such files. If no participant marked anything, there are no picks.
GroundTruth read_ground_truth(const DatasetItem& item, std::size_t n_vertices);

}  // namespace salbench
