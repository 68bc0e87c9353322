// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/artefact.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace salbench {

Artefact artefact_of(Recipe recipe, std::string_view kind, const Arrays& arrays, ArtefactNote note) {
  Artefact artefact{.recipe = std::move(recipe), .kind = std::string(kind), .note = std::move(note)};
  artefact.key = key_of(artefact.recipe);
  artefact.content = content_digest(arrays);
  for (const Array& array : arrays) artefact.arrays.push_back(pack(array));
  std::ranges::sort(artefact.arrays, {}, &PackedArray::name);
  return artefact;
}

Arrays arrays_of(const Artefact& artefact) {
  Arrays arrays;
  for (const PackedArray& packed : artefact.arrays) arrays.push_back(unpack(packed));
  return arrays;
}

Attributes lasting_attributes_of(const Artefact& artefact) {
  const Recipe& recipe = artefact.recipe;
  return {{"kind", artefact.kind},
          {"stage", recipe.stage},
          {"stage_version", std::int64_t{recipe.stage_version}},
          {"options", recipe.options},
          {"seed", recipe.seed},
          {"inputs", inputs_text(recipe)},
          {"key", artefact.key.hex()},
          {"content", artefact.content.hex()}};
}

Attributes attributes_of(const Artefact& artefact) {
  const ArtefactNote& note = artefact.note;
  Attributes attributes = lasting_attributes_of(artefact);
  attributes.insert(attributes.begin(), {"item", note.item});
  attributes.emplace_back("seconds", note.seconds);
  attributes.insert(attributes.end(), note.attributes.begin(), note.attributes.end());
  if (!note.remark.empty()) attributes.emplace_back("remark", note.remark);
  return attributes;
}

std::uint64_t bytes_of(const Artefact& artefact) {
  std::uint64_t bytes = 0;
  for (const PackedArray& packed : artefact.arrays) bytes += bytes_of(packed);
  return bytes;
}

std::string item_label(std::string_view item) {
  std::string label(item.substr(0, 60));
  for (char& c : label)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return label;
}

}  // namespace salbench
