// SPDX-License-Identifier: GPL-3.0-or-later
// Artefacts of a run in one self-contained HDF5 file (docs/data_dictionary.md):
//   /ITEM/STAGE/...              the data sets of an artefact, its attributes on the group
//   /means/STAGE/{meshes,scans}  mean histograms over the items of the export
//   /scores                      one table, one row per item and model
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "pipeline/run/session.h"

namespace salbench {

using StageNames = std::set<std::string, std::less<>>;

// Throws ConfigError if two shapes of a run share a name, or have one of `taken`: a mesh file may be called
// "52_3", like scan 3 of mesh 52.
void require_distinct_names(const RunState& run, StageNames taken = {});

// Writes the known results of the named stages, item by item; failed and inapplicable ones are left out.
// `target` appears only when complete: if the session is stopped, the partial file is removed. With `link`,
// groups are links to the artefacts, each of which has been read and verified. Throws ConfigError for
// duplicate names, and StorageError.
void export_file(Session& session, const StageNames& stages, const std::filesystem::path& target, bool link);

}  // namespace salbench
