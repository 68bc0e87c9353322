// SPDX-License-Identifier: GPL-3.0-or-later
// THE table of rows: everything there is to compute for a data set, from what, and how. Its order is that of
// the paper's pipeline: load, scan, normals, descriptors, models, histogram matching, metrics.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pipeline/catalog/config.h"
#include "pipeline/catalog/row.h"

namespace salbench {

// Kinds of shapes that the files of a data set hold.
struct DataKinds {
  bool meshes = true;
  bool clouds = false;
};

// A reference histogram that is given takes the place of the data set's own mean. There are rows for what the
// data set holds and the configuration asks for; point clouds are always evaluated.
Catalog make_catalog(const Config& config, const std::optional<Histogram>& given_reference = {},
                     const DataKinds& kinds = {});

std::string node_name(const Row& row);  // "fpfh of scans": kinds of shapes may have rows of one name

// Configuration path of a row's option, such as "fpfh.radius"; the bare key if no section has it.
std::string option_path(const Row& row, std::string_view key);

// The rows given and all that they read, directly or not: [row]. Rows with a given value read nothing.
std::vector<bool> ancestors(const Catalog& catalog, const std::vector<std::size_t>& rows);

}  // namespace salbench
