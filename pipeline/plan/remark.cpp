// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan/remark.h"

#include <cstdint>
#include <vector>

namespace salbench {
namespace {

Recipe recipe_of_remark(const std::string& stage, const Digest& key) {
  return {std::string(kRemarkStage), 1, {}, {}, {{stage, key}}};
}

}  // namespace

Digest remark_key(const std::string& stage, const Digest& key) {
  return key_of(recipe_of_remark(stage, key));
}

void save_remark(Store& store, const std::string& stage, const Digest& key, const ArtefactNote& note,
                 std::string_view remark) {
  const Arrays arrays = {{"text",
                          {remark.size()},
                          std::vector<std::uint8_t>(remark.begin(), remark.end()),
                          "1",
                          "UTF-8, one line"}};
  store.save(recipe_of_remark(stage, key), kRemarkStage, arrays, note);
}

std::string load_remark(Store& store, const std::string& stage, const Digest& key) {
  const auto arrays = store.load(kRemarkStage, remark_key(stage, key));
  const Array* text = arrays ? find_array(*arrays, "text") : nullptr;
  const auto* bytes = text == nullptr ? nullptr : std::get_if<std::vector<std::uint8_t>>(&text->values);
  return bytes == nullptr ? std::string() : std::string(bytes->begin(), bytes->end());
}

}  // namespace salbench
