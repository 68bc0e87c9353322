// SPDX-License-Identifier: GPL-3.0-or-later
// Remarks on odd shapes are artefacts of their own, beside those of the shapes: a run that finds a shape in
// the cache finds the remark on it, too. A usual shape has none, so nothing is read for it.
#pragma once

#include <string>
#include <string_view>

#include "cache/store.h"

namespace salbench {

inline constexpr std::string_view kRemarkStage = "remark";

// Key of the remark on the result that has this key in the stage.
Digest remark_key(const std::string& stage, const Digest& key);

void save_remark(Store& store, const std::string& stage, const Digest& key, const ArtefactNote& note,
                 std::string_view remark);
std::string load_remark(Store& store, const std::string& stage, const Digest& key);  // empty: none

}  // namespace salbench
