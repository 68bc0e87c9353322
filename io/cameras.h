// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras of a data set: the places that its shapes were seen from, as a description gives them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "stages/core/viewpoint.h"

namespace salbench {

// One of three: a place for everything, one per view, or a file. Empty: all of a shape was seen.
struct Cameras {
  std::map<std::string, Vec3> by_view = {};  // "": every view
  std::string file = {};                     // CSV, below the folder of the data set
  bool at_infinity = false;                  // they are directions
  std::string where = {};                    // of the description

  bool empty() const { return by_view.empty() && file.empty(); }
};

struct ItemCamera {
  Viewpoint from;
  std::string where;  // it is written: file and line
};

// Reads the file, if there is one: columns x, y, z, and item or view or both.
class FoundCameras {
 public:
  // Throws InputError, one line that names file and line: for a missing column, a coordinate that is not a
  // finite number, a direction without length, and a camera that is given twice.
  FoundCameras(const std::filesystem::path& root, const Cameras& cameras);

  const ItemCamera* find(const std::string& item, const std::string& view) const;  // null if there is none

 private:
  std::map<std::pair<std::string, std::string>, ItemCamera> cameras_;  // "": every item, every view
};

// "has no length" or "is not finite"; empty if the coordinates can be a camera's.
std::string_view wrong_with_camera(const Vec3& place, bool at_infinity);

}  // namespace salbench
