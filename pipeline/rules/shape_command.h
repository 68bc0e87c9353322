// SPDX-License-Identifier: GPL-3.0-or-later
// A command of the user that computes saliency: the files it is given, and the file it must write.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/package/command_servers.h"
#include "pipeline/package/importer.h"
#include "pipeline/rules/depended_files.h"
#include "stages/core/types.h"

namespace salbench {

// A placeholder in a command line, and the file in the scratch folder of a shape that it is replaced by.
struct Placeholder {
  std::string_view text, file;
};
inline constexpr std::array<Placeholder, 5> kPlaceholders = {{{"{mesh}", "shape.ply"},
                                                              {"{shape}", "shape.h5"},
                                                              {"{out}", "out.val"},
                                                              {"{out.npy}", "out.npy"},
                                                              {"{out.h5}", "out.h5"}}};
// Path of the file that the shape was read from, beside which its textures lie; and the shape's name.
inline constexpr std::string_view kSource = "{source}", kItem = "{item}";
// Placeholders of a list of shapes. Each line of it names two files: that of {mesh}, or of {shape}, and that
// of {out}.
inline constexpr std::string_view kListOfMeshes = "{list}", kListOfShapes = "{list.h5}";

// The parts of a shape that a command may read; a job loads those in `reads`.
struct ShapeParts {
  Points points;
  const Normals* normals = nullptr;
  Surface faces = {};
  const Descriptors* fpfh = nullptr;
  std::string source = {}, item = {};  // path of the file that it was read from; its name
};

// Runs the command for one shape, or with a list, keeps it at work for one after the other.
class ShapeCommand {
 public:
  // The name is the model's, for messages.
  ShapeCommand(const std::string& name, std::string command, std::chrono::duration<double> timeout,
               std::shared_ptr<DependedFiles> depends);

  // The values that it writes, one per point, or per face where there are `mapped_faces`. Several threads may
  // ask. Throws InputError if it fails, Interrupted and StorageError (io/commands/process.h).
  ScalarField map(const ShapeParts& shape, std::size_t mapped_faces);

 private:
  bool has(std::string_view placeholder) const { return command_.find(placeholder) != std::string::npos; }
  std::string run(const std::filesystem::path& folder, const ShapeParts& shape);
  std::string ask(const std::filesystem::path& folder);

  std::string command_;
  std::chrono::duration<double> timeout_;
  std::shared_ptr<DependedFiles> depends_;
  std::optional<CommandServers> servers_;  // of a command that has a list
  std::atomic<bool> has_answered_ = false;
  std::atomic<int> late_ = 0;  // shapes without an answer, as long as there was none
  Importer importer_;          // of HDF5 files that it writes
};

}  // namespace salbench
