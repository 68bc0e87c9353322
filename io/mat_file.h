// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers from MATLAB's files of version 5 (-v6, -v7).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

bool is_mat(std::string_view bytes);  // of any version from 5 on

// The numbers of a real numeric variable, column by column; or of one cell of a cell array, `cell` being its
// row and column from 1, as text. A child process runs the library that reads them, which damaged bytes may
// crash. Safe to call from several threads. Throws InputError that names file, variable and what was
// expected.
ScalarField parse_mat(std::string_view bytes, std::string_view name, const std::string& variable,
                      const std::vector<std::string>& cell = {});

}  // namespace salbench
