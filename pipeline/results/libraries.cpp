// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/libraries.h"

#include <fmt/format.h>
#include <tbb/version.h>

#include "io/hdf5/hdf5_file.h"
#include "stages/core/embree.h"

namespace salbench {
namespace {

// "2021.8.0" begins with the "2021.8" of the headers.
std::string text_of(const char* name, const LibraryVersion& version) {
  const bool other = !version.loaded.starts_with(version.built);
  return fmt::format("{} {}{}", name, version.loaded,
                     other ? fmt::format(" (built with {})", version.built) : "");
}

}  // namespace

std::vector<std::string> libraries() {
  return {text_of("oneTBB", {TBB_VERSION_STRING, TBB_runtime_version()}),
          text_of("HDF5", hdf5_version()),
          fmt::format("Embree {}", embree::version()),
          "Eigen " SALBENCH_EIGEN,
          "PCL " SALBENCH_PCL,
          "CGAL " SALBENCH_CGAL};
}

}  // namespace salbench
