// SPDX-License-Identifier: GPL-3.0-or-later
// Models that are commands of the user: a section under `models` with a key `command`, whose name is none of
// the built-in ones. The front runs it for each shape; from there on the map is like any other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/rules/models.h"

namespace salbench {

struct CommandOptions {
  std::string command = {};  // {mesh}, {shape} and {out} stand for files, {list} for a list of them
  Words reads = {"mesh"};    // points, normals, faces, fpfh; mesh: the first three
  std::int32_t version = 1;  // raised by the user when the command's output changes otherwise
  double timeout = 600;      // s
  std::int32_t at_once = 0;  // commands of this model at work at the same time; 0: no limit
  std::int32_t gpu = 0;      // the same where the command keeps a GPU busy: so many GPUs
  Words depends = {};        // files whose content counts
  Words trained_on = {};     // items and splits
  std::string trained = {};  // how, in words: "cross-validated, 5 folds by class"

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

// A key has one option for each file that a command depends on: this and the file's name, and as its value
// the file's digest.
inline constexpr std::string_view kDependsOption = "depends on ";

// Throws ConfigError for a section, of a model that is not known, that has a command line under another key,
// such as `comand`.
void reject_misspelt_command(const std::string& name, const Section& models);

// Throws ConfigError.
Model command_model(const std::string& name, const Section& models);

}  // namespace salbench
