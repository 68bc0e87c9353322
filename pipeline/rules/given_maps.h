// SPDX-License-Identifier: GPL-3.0-or-later
// Saliency maps computed by other programs, used in place of a model's.
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
  std::filesystem::path source;  // folder with ITEM.val (.txt, .csv, .npy), or HDF5 file with a data set ITEM
  bool matched = false;          // values are already histogram-matched, in [0, 1]
  std::map<std::string, File> files = {};  // by item: "52", "52_3"

  // Parses a map of n_points finite numbers, or n_faces if faces are scored; for a point cloud it may have a
  // value for every point of its file. Throws InputError.
  ScalarField checked(const FileData& data, const std::string& item, std::size_t n_points,
                      std::size_t n_faces = 0, const PointCloud* cloud = nullptr) const;

  std::string place(const std::string& item) const;  // expected location of the item's map, for messages
};

// Lists the folder, or the data sets of the HDF5 file by the front. Of several files for one item .val is
// taken; without it they fail the item. Throws ConfigError if it is neither.
GivenMaps find_given_maps(const std::filesystem::path& source, bool matched, const Front& front = {});

// Maps as files of the units of the given levels: [level]. If no shape of a level has a map, none is
// expected; otherwise a missing map fails its unit. If faces are scored, a map may have one value per face of
// the mesh's file, before polygons are split; triangles take the value of their polygon. Throws ConfigError
// if no unit has a map, or a map belongs to two units of the same name.
std::map<Level, FilesOfUnits> map_files(const GivenMaps& maps, const Units& units,
                                        const std::vector<Level>& levels, bool on_faces = false);

}  // namespace salbench
