// Subcommand `export`: everything known of some items, as files that other programs open.
#pragma once

#include <atomic>
#include <string>

#include "pipeline/commands.h"

namespace salbench {

struct ExportOptions {
  std::string stages;  // "scan,fpfh,map": stages, or what stands before the point in theirs; empty: all
  std::string format = "h5";  // one HDF5 file; or the name of a ShapeFormat: a folder of shapes
  bool link = false;          // h5: refer to the artefacts in the cache, do not copy them
};

// Computes what is missing first. Throws as the other subcommands do (commands.h).
ExitStatus export_command(const Arguments& arguments, const ExportOptions& options,
                          const std::atomic<bool>& stop);

}  // namespace salbench
