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

// Throws ConfigError where two shapes of a run have one name, or one of these: a mesh file may be called
// "52_3", as the scan 3 of the mesh 52 is.
void require_distinct_names(const RunState& run, StageNames taken = {});

// After a run: writes what it knows of the stages named, item by item; what failed or does not apply is not
// there. Nothing has the name `target` before the file is complete: where the session is stopped before that,
// the part written is removed. With `link`, groups are links to the artefacts, each of which has been read
// and found whole. Throws ConfigError where two things would have the same name, StorageError.
void export_file(Session& session, const StageNames& stages, const std::filesystem::path& target, bool link);

}  // namespace salbench
