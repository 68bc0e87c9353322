// SPDX-License-Identifier: GPL-3.0-or-later
// Saliency maps made outside of the program, which stand where a model's would be computed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/inputs/front.h"
#include "pipeline/inputs/inputs.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

struct GivenMaps {
  std::filesystem::path source;            // a folder with ITEM.val, or an HDF5 file with a data set ITEM
  bool matched = false;                    // the values are histogram-matched already: they lie in [0, 1]
  std::map<std::string, File> files = {};  // of maps, by item: "52", "52_3"

  // The data as a map of n_points finite numbers, or n_faces where faces are scored; of a point cloud they
  // may count all points of its file. Throws InputError.
  ScalarField checked(const FileData& data, const std::string& item, std::size_t n_points,
                      std::size_t n_faces = 0, const PointCloud* cloud = nullptr) const;

  std::string place(const std::string& item) const;  // for a message: where the item's map is looked for
};

// Lists the folder, or the data sets of the file, which the front reads. Throws ConfigError where it is
// neither.
GivenMaps find_given_maps(const std::filesystem::path& source, bool matched, const Front& front = {});

// The maps as files of the units of the levels given: [level]. Where no shape of a level has a map, none is
// expected of any; otherwise a missing one is its unit's failure. Where faces are scored, values of the faces
// of a mesh's file, as many as there are before polygons are split, are read as those of their triangles.
// Throws ConfigError if no unit has one.
std::map<Level, FilesOfUnits> map_files(const GivenMaps& maps, const Units& units,
                                        const std::vector<Level>& levels, bool on_faces = false);

}  // namespace salbench
