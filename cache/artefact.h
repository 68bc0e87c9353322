// SPDX-License-Identifier: GPL-3.0-or-later
// A result with all that the cache knows of it.
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
  std::string item;            // a label for people; never looked up
  double seconds = 0;          // wall time of the computation
  std::string remark = {};     // on an odd item, one line
  Attributes attributes = {};  // of the run
};

struct Artefact {
  Recipe recipe;
  std::string kind;  // layout of its arrays
  ArtefactNote note;
  Digest key = {}, content = {};
  std::vector<PackedArray> arrays = {};  // by name
};

using ArtefactPtr = std::shared_ptr<const Artefact>;

Artefact artefact_of(Recipe recipe, std::string_view kind, const Arrays& arrays, ArtefactNote note);

Arrays arrays_of(const Artefact& artefact);  // throws InputError where its arrays are damaged
// All of it but the arrays, as text and numbers; and what every computation of it has alike.
Attributes attributes_of(const Artefact& artefact);
Attributes lasting_attributes_of(const Artefact& artefact);
std::uint64_t bytes_of(const Artefact& artefact);  // of its arrays, as they are stored

// Letters, digits, '-' and '_' stay; everything else becomes '_'; at most 60 bytes.
std::string item_label(std::string_view item);

}  // namespace salbench
