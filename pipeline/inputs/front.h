// SPDX-License-Identifier: GPL-3.0-or-later
// Callbacks by which a run asks its Python front for data sets that C++ does not list or read, files of other
// programs, and commands of the user. They are called from several threads at a time. salbench-engine sets
// none.
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

// Input of a function or command that serves as a model. Parts that it does not read are null or empty.
struct FunctionInput {
  std::string item;
  Points points;
  const Normals* normals = nullptr;
  Surface faces = {};
  const Descriptors* fpfh = nullptr;
  std::size_t mapped_faces = 0;  // face values that a map may have instead of point values
  std::string source = {};       // path of the shape's file
};
using FunctionCall = std::function<ScalarField(const FunctionInput&)>;

struct DependedFile {
  std::string name;  // name in the configuration
  std::filesystem::path path;
  Digest digest;
};

// Command line of a model with its settings.
struct CommandLine {
  std::string model, line;
  double timeout = 600;  // s, per shape
  std::vector<DependedFile> depends;
};

// All callbacks throw InputError, StorageError, and Interrupted when the run is asked to stop. Files are read
// in separate processes, whose crash does not harm the run.
struct Front {
  // Data set passed to the run in place of a layout and a folder; nullopt if none was.
  std::function<Dataset()> dataset;
  // Lists the items of a data set that C++ does not list, with its reader. No shape is read.
  std::function<Dataset(const std::filesystem::path& root, const std::string& layout)> list;
  // End of a message on a folder that does not match its layout: "; the layout that fits: sal3d; ...".
  std::function<std::string(const std::filesystem::path& root)> layouts_that_fit;
  std::function<PointCloud(const std::filesystem::path& file)> read_cloud;  // PCD or XYZ
  // File in the HDF5 form that another program wrote, with all its views; `shape` is the expected name.
  std::function<ShapeInForm(const std::filesystem::path& file, const std::string& shape)> read_form;
  // HDF5 files of maps, one data set per map; read_map also takes the .npy file of the map `name`.
  std::function<std::vector<std::string>(const std::filesystem::path& file)> names_of_maps;
  std::function<ScalarField(const std::filesystem::path& file, const std::string& name)> read_map;
  std::function<FunctionCall(const CommandLine&)> command;
};

// Returns the callback. Throws an error that begins with `what` if the front has none, as in salbench-engine.
template <class Error = ConfigError, class Function>
const Function& answering(const Function& function, const std::string& what) {
  if (!function)
    throw Error(what +
                " needs the command salbench of the Python package; salbench-engine reads meshes and .ply in "
                "the layouts schelling, folder and hdf5, and runs the models of its table");
  return function;
}

}  // namespace salbench
