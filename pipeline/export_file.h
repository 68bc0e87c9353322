// What a run knows, as one self-contained HDF5 file (docs/data_dictionary.md):
//   /ITEM/STAGE/...              the data sets of an artefact, its attributes on the group
//   /means/STAGE/{meshes,scans}  mean histograms over the items of the export
//   /scores                      one table: a row an item and model
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "io/hdf5_file.h"
#include "pipeline/session.h"

namespace salbench {

using StageNames = std::set<std::string, std::less<>>;

// After the session's run: what it knows of the stages named; what failed or does not apply is not there.
// With `links_from`, the folder that the file will lie in, groups are links to the artefacts, each of which
// has been read and found whole. Throws ConfigError where two things would have the same name.
Hdf5Content export_content(Session& session, const StageNames& stages,
                           const std::optional<std::filesystem::path>& links_from);

}  // namespace salbench
