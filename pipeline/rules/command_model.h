// SPDX-License-Identifier: GPL-3.0-or-later
// Models that are commands of the user: sections under `models` with a key `command` and a name that is not
// built in. The front runs the command for each shape; its map is then treated like any other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/rules/models.h"

namespace salbench {

struct CommandOptions {
  std::string command = {};  // placeholders: {mesh}, {shape}, {out} are files, {list} a list of them
  Words reads = {"mesh"};    // points, normals, faces, fpfh; "mesh" means the first three
  std::int32_t version = 1;  // raised by the user when the output changes for another reason
  double timeout = 600;      // s
  std::int32_t at_once = 0;  // concurrent commands of this model; 0: no limit
  std::int32_t gpu = 0;      // the same for commands that occupy a GPU: number of GPUs
  Words depends = {};        // files whose content enters the key
  Words trained_on = {};     // items and splits
  std::string trained = {};  // training procedure: "cross-validated, 5 folds by class"

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("command", self.command,
          {"run by sh; {mesh} is a PLY file, {shape} HDF5, {out} what it must write; {list} many shapes"});
    visit("reads", self.reads, {"what it is given: mesh, or some of points, normals, faces, fpfh"});
    visit("version", self.version,
          {"to be raised when the output changes for other reasons", {}, at_least(1)});
    visit("timeout", self.timeout, {"of one shape", "s", above(0)});
    visit("at_once", self.at_once, {"commands at work at the same time, 0: no limit", {}, at_least(0)});
    visit("gpu", self.gpu, {"GPUs: the same limit by another name", {}, at_least(0)});
    visit("depends", self.depends, {"files whose content counts, copied into the command's folder"});
    visit(
        "trained_on", self.trained_on,
        {"items and splits that the model was trained on: tables name those that are scored", "", {}, "[]"});
    visit("trained", self.trained, {"how it learned, in words: tables and pages repeat it"});
  }
};

// Prefix of the option by which a key contains a file that a command depends on: name of the file, with its
// digest as the value.
inline constexpr std::string_view kDependsOption = "depends on ";

// Throws ConfigError for the section of an unknown model with a command line under another key, such as
// `comand`.
void reject_misspelt_command(const std::string& name, const Section& models);

// Throws ConfigError.
Model command_model(const std::string& name, const Section& models);

}  // namespace salbench
