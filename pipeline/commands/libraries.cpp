// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/libraries.h"

#include <tbb/version.h>

#include "io/hdf5_file.h"
#include "stages/core/embree.h"

namespace salbench {
namespace {

Library of(const char* name, const LibraryVersion& version) { return {name, version.built, version.loaded}; }

// "2021.8.0" begins with the "2021.8" of the headers.
LibraryVersion tbb_version() { return {TBB_VERSION_STRING, TBB_runtime_version()}; }

}  // namespace

std::vector<Library> libraries() {
  return {of("oneTBB", tbb_version()),   of("HDF5", hdf5_version()), of("Embree", embree::library_version()),
          {"Eigen", SALBENCH_EIGEN, {}}, {"PCL", SALBENCH_PCL, {}},  {"CGAL", SALBENCH_CGAL, {}}};
}

}  // namespace salbench
