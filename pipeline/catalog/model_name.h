// SPDX-License-Identifier: GPL-3.0-or-later
// Names that a model may have which is not in the table of models.
#pragma once

#include <string>
#include <string_view>

namespace salbench {

// Why a model cannot have this name; empty if it can. Names stand in tables, folders and keys.
std::string wrong_with_model_name(std::string_view name);

}  // namespace salbench
