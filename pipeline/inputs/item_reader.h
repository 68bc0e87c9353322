// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the shape of an item, and what of its ground truth the same file holds, whoever reads the file.
#pragma once

#include <filesystem>
#include <optional>

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "pipeline/inputs/front.h"

namespace salbench {

// Several threads may call it. Throws InputError, one line that names the file.
class ItemReader {
 public:
  explicit ItemReader(Front front = {}, ReadItem read = {});  // read: of a data set that the front reads

  // Shape and ground truth of an item that the front reads.
  ShapeInForm read(const Files& files) const;

  // The shape of another item as its file has it, polygons split.
  ShapeInForm shape(const Files& files, bool is_cloud) const;

  // An item that is stored in the HDF5 form, with the ground truth of its view if `with_truth`; nothing for
  // items in other files.
  std::optional<ShapeInForm> form(const Files& files, bool with_truth) const;

 private:
  Front front_;
  ReadItem read_;
};

}  // namespace salbench
