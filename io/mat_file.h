// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers from MATLAB's files of version 5 (-v6, -v7).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

bool is_mat(std::string_view bytes);  // of any version from 5 on

// A child process runs the library that reads the numbers, which damaged bytes may crash. Both functions are
// safe to call from several threads, and throw InputError that names file, variable and what was expected.

// The numbers of a real numeric variable, a row or a column.
ScalarField parse_mat_values(std::string_view bytes, std::string_view name, const std::string& variable);

// Those of a variable of any shape, column by column; or of one cell of a cell array, `cell` being its row
// and column from 1, as text.
ScalarField parse_mat(std::string_view bytes, std::string_view name, const std::string& variable,
                      const std::vector<std::string>& cell = {});

}  // namespace salbench
