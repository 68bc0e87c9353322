// SPDX-License-Identifier: GPL-3.0-or-later
// Reads items that are stored in the one form; the front reads what other programs wrote: archives of data
// sets, and HDF5 files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "pipeline/inputs/front.h"

namespace salbench {

// Several threads may call it. Throws InputError, one line that names the file.
class Importer {
 public:
  explicit Importer(Front front = {}, DataImporter of = {});  // of: the data set as it was listed

  // Reads an item that the front has listed, from the very bytes that a key names.
  ShapeInForm item(const Files& files) const;

  // Reads an item that is stored in the one form, with the ground truth of its view if `with_truth`; returns
  // nothing for other items. The front reads files that salbench did not write.
  std::optional<ShapeInForm> form_in(const Files& files, bool with_truth) const;

 private:
  std::string asked(const std::string& what,
                    const std::vector<std::pair<std::string, std::string>>& of) const;

  Front front_;
  DataImporter of_;
};

// Values of an answer of the front: float64 as they lie in memory. `about` names their file in messages.
ScalarField values_in_bytes(const std::string& bytes, const std::string& about);

}  // namespace salbench
