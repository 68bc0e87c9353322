// SPDX-License-Identifier: GPL-3.0-or-later
// A stored result with its metadata.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cache/key.h"
#include "io/arrays.h"
#include "io/digest.h"
#include "io/hdf5/packed_array.h"

namespace salbench {

struct ArtefactNote {
  std::string item;            // label for people; never used for look-up
  double seconds = 0;          // wall time of the computation
  std::string remark = {};     // note on an unusual item, one line
  Attributes attributes = {};  // attributes of the run
};

struct Artefact {
  Recipe recipe;
  std::string kind;  // layout of the arrays
  ArtefactNote note;
  Digest key = {}, content = {};
  std::vector<PackedArray> arrays = {};  // sorted by name
};

using ArtefactPtr = std::shared_ptr<const Artefact>;

Artefact artefact_of(Recipe recipe, std::string_view kind, const Arrays& arrays, ArtefactNote note);

Arrays arrays_of(const Artefact& artefact);  // throws InputError if the arrays are damaged
// Metadata as text and numbers; and the part of it that is equal for every computation of the artefact.
Attributes attributes_of(const Artefact& artefact);
Attributes lasting_attributes_of(const Artefact& artefact);
std::uint64_t bytes_of(const Artefact& artefact);  // size of its arrays as stored

// Keeps letters, digits, '-' and '_', replaces others by '_'; at most 60 bytes.
std::string item_label(std::string_view item);

}  // namespace salbench
