// SPDX-License-Identifier: GPL-3.0-or-later
// Reads items in the one form, and what other programs wrote, through processes of the Python package that
// stay at work: archives of data sets, and HDF5 files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "pipeline/package/command_servers.h"

namespace salbench {

// A process is started when none is idle, and ended with the object; several threads may ask. What is wrong
// with a file is InputError, one line that names it; so is a process that crashed on it, or took too long.
// All functions throw Interrupted and StorageError as well (io/commands/process.h).
class Importer {
 public:
  // The data set as it was listed. Nothing is started yet.
  explicit Importer(DataImporter of = {});

  // The one form of an item that was listed with an importer, made of the very bytes that a key names.
  ShapeInForm item(const Files& files);

  // That of an item whose file is in the one form, with the ground truth of its view if `with_truth`; nothing
  // of another item. Read without a process, if a program of ours wrote it.
  std::optional<ShapeInForm> form_in(const Files& files, bool with_truth);

  // Of an HDF5 file: the names of its data sets of numbers; one of them as a value per point; the only one,
  // or the one that is called "saliency".
  std::vector<std::string> maps(const std::filesystem::path& file);
  ScalarField map(const std::filesystem::path& file, const std::string& name);
  ScalarField values(const std::filesystem::path& file);

 private:
  // The bytes that answer a request. `about`: names the file in messages about the process.
  std::string answer(const std::string& request, const std::string& about);
  ScalarField values_in(const std::string& request, const std::string& about);

  DataImporter of_;
  CommandServers servers_;
};

}  // namespace salbench
