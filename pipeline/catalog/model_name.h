// SPDX-License-Identifier: GPL-3.0-or-later
// Names that a model may have which is not in the table of models.
#pragma once

#include <string>
#include <string_view>

namespace salbench {

// What is wrong with the name; empty if it can stand in tables, folders and keys beside the built-in models.
std::string wrong_with_model_name(std::string_view name);

}  // namespace salbench
