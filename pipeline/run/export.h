// SPDX-License-Identifier: GPL-3.0-or-later
// Exports the results of a run as files for viewers and other programs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "pipeline/run/session.h"

namespace salbench {

enum class ExportForm { h5, ply, maps };  // one HDF5 file; TO/ITEM.ply; TO/MODEL/ITEM.val, one value per line
template <>
struct EnumNames<ExportForm> {
  static constexpr std::array<std::string_view, 3> names{"h5", "ply", "maps"};
};

struct ExportOptions {
  std::filesystem::path to;
  ExportForm form = ExportForm::h5;
  std::string stages = {};  // stages, or their names up to the point: "scan,fpfh,map"; empty: all
  bool link = false;        // h5: link to the artefacts in the cache instead of copying
  bool for_report = false;  // h5: contents of a report
};

// Adds to a request what the export needs: cached pictures, and for a report missing ones too, but no missing
// maps. Throws ConfigError for options that exclude each other.
Request request_of_export(Request request, const ExportOptions& options);

// Computes what is missing, and writes. Returns the number of shapes or maps. If the session is stopped, no
// file appears under its final name. Throws ConfigError if a user's file would be overwritten, and
// StorageError.
std::size_t export_run(Session& session, const ExportOptions& options, int threads);

}  // namespace salbench
