// SPDX-License-Identifier: GPL-3.0-or-later
// Callbacks by which a run asks the front that started it for the work of Python: data sets that C++ does not
// list or read, files that other programs wrote, commands of the user. Threads of the run call them, several
// at a time. salbench-engine sets none.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/digest.h"
#include "io/shapes/dataset.h"
#include "stages/core/errors.h"
#include "stages/core/types.h"
#include "stages/descriptors/fpfh.h"

namespace salbench {

// Input of a function or a command that is a model. Parts that it does not read are null or empty.
struct FunctionInput {
  std::string item;
  Points points;
  const Normals* normals = nullptr;
  Surface faces = {};
  const Descriptors* fpfh = nullptr;
  std::size_t mapped_faces = 0;  // that may have values in place of the points
  std::string source = {};       // path of the file that the shape was read from
};
using FunctionCall = std::function<ScalarField(const FunctionInput&)>;

struct DependedFile {
  std::string name;  // as the configuration has it
  std::filesystem::path path;
  Digest digest;
};

// The command line of a model, with what it stands on.
struct CommandLine {
  std::string model, line;
  double timeout = 600;  // s, of one shape
  std::vector<DependedFile> depends;
};

// All callbacks throw InputError, StorageError, and Interrupted when the run is asked to stop. Files are read
// in processes of their own, which may crash without harm to the run.
struct Front {
  // The data set of a run that was given one, in place of a layout and a folder; nothing if it was not.
  std::function<Dataset()> dataset;
  // Lists the items of a data set that C++ does not list, with what reads them. No shape is read.
  std::function<Dataset(const std::filesystem::path& root, const std::string& layout)> list;
  // The end of a message on a folder that is not as its layout says: "; the layout that fits: sal3d".
  std::function<std::string(const std::filesystem::path& root)> layouts_that_fit;
  std::function<PointCloud(const std::filesystem::path& file)> read_cloud;  // PCD or XYZ
  // A file in the HDF5 form that another program wrote, with all its views; `shape` is the name that it
  // should be of.
  std::function<ShapeInForm(const std::filesystem::path& file, const std::string& shape)> read_form;
  // HDF5 files of maps, a data set each.
  std::function<std::vector<std::string>(const std::filesystem::path& file)> names_of_maps;
  std::function<ScalarField(const std::filesystem::path& file, const std::string& name)> read_map;
  std::function<FunctionCall(const CommandLine&)> command;
};

// Returns the callback. Throws an error if the front has none, as in salbench-engine; `what` begins the
// message.
template <class Error = ConfigError, class Function>
const Function& answering(const Function& function, const std::string& what) {
  if (!function)
    throw Error(what +
                " needs the command salbench of the Python package; salbench-engine reads meshes and .ply in "
                "the layouts schelling, folder and hdf5, and runs the models of its table");
  return function;
}

}  // namespace salbench
