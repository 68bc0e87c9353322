// SPDX-License-Identifier: GPL-3.0-or-later
// Callbacks by which a run asks the front that started it for the work of Python: data sets that C++ does not
// list, files that other programs wrote, commands of the user. Threads of the run call them, several at a
// time. salbench-engine sets none.
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

// Request to a reader process, which may crash without harm to the run. `what` selects the answer
// (python/salbench/datasets/worker.py).
struct ReadRequest {
  std::string what;
  std::vector<std::pair<std::string, std::string>> arguments;
};

// All callbacks throw InputError, StorageError, and Interrupted when the run is asked to stop.
struct Front {
  // Lists the items of a layout that C++ does not list. No shape is read.
  std::function<Dataset(const std::filesystem::path& root, const std::string& layout)> list;
  // The end of a message on a folder that is not as its layout says: "; the layout that fits: sal3d".
  std::function<std::string(const std::filesystem::path& root)> layouts_that_fit;
  std::function<std::string(const ReadRequest&)> read;  // the bytes of the answer
  std::function<std::vector<std::string>(const std::filesystem::path& file)>
      names_of_maps;  // in an HDF5 file
  std::function<FunctionCall(const CommandLine&)> command;
};

// Returns the callback. Throws ConfigError if the front has none, as in salbench-engine; `what` begins the
// message.
template <class Function>
const Function& answering(const Function& function, const std::string& what) {
  if (!function)
    throw ConfigError(what +
                      " needs the command salbench of the Python package; salbench-engine reads the "
                      "layouts schelling, folder and hdf5, and runs the models of its table");
  return function;
}

}  // namespace salbench
