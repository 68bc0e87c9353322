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
  std::string stages = {};  // "scan,fpfh,map": stages, or what stands before the point in theirs; empty: all
  bool link = false;        // h5: refer to the artefacts in the cache, do not copy them
  bool for_report = false;  // h5: what a report shows
};

// Adds to a request what the export needs: pictures that are cached, and for a report also those that are
// not, but no map that is not there. Throws ConfigError for options that exclude each other.
Request request_of_export(Request request, const ExportOptions& options);

// Computes what is missing, and writes. Returns the number of shapes, or maps; nothing is written under its
// name where the session is stopped. Throws ConfigError where a file of the user would be overwritten, and
// StorageError.
std::size_t export_run(Session& session, const ExportOptions& options, int threads);

}  // namespace salbench
