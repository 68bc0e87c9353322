// SPDX-License-Identifier: GPL-3.0-or-later
// Reads items in the one form, and through the front what other programs wrote: archives of data sets, and
// HDF5 files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "pipeline/inputs/front.h"

namespace salbench {

// Several threads may ask. What is wrong with a file is InputError, one line that names it.
class Importer {
 public:
  explicit Importer(Front front = {}, DataImporter of = {});  // of: the data set as it was listed

  // The one form of an item that the front has listed, made of the very bytes that a key names.
  ShapeInForm item(const Files& files) const;

  // That of an item whose file is in the one form, with the ground truth of its view if `with_truth`; nothing
  // of another item. The front is asked where no program of ours wrote it.
  std::optional<ShapeInForm> form_in(const Files& files, bool with_truth) const;

 private:
  std::string asked(const std::string& what,
                    const std::vector<std::pair<std::string, std::string>>& of) const;

  Front front_;
  DataImporter of_;
};

// Numbers as they lie in memory, which is how the front answers. `about` names their file in messages.
ScalarField values_in_bytes(const std::string& bytes, const std::string& about);

}  // namespace salbench
