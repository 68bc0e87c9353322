// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the shape of an item, and the ground truth in the same file, for all readers.
#pragma once

#include <filesystem>
#include <optional>

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "pipeline/inputs/front.h"

namespace salbench {

// Thread-safe. Throws InputError, one line that names the file.
class ItemReader {
 public:
  explicit ItemReader(Front front = {}, ReadItem read = {});  // read: set for a data set that the front reads

  // Shape and ground truth of an item that the front reads.
  ShapeInForm read(const Files& files) const;

  // Shape of any other item as in its file, with polygons split.
  ShapeInForm shape(const Files& files, bool is_cloud) const;

  // Item stored in the HDF5 form, with the ground truth of its view if `with_truth`; nullopt for other files.
  std::optional<ShapeInForm> form(const Files& files, bool with_truth) const;

 private:
  Front front_;
  ReadItem read_;
};

}  // namespace salbench
