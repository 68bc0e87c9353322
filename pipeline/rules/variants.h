// SPDX-License-Identifier: GPL-3.0-or-later
// Variants of a built-in model: sections under `models` with a key `model`, such as {model: LS, foci_sigma:
// 0.08}. Other options are those of the model's own section. A section with a `grid` defines a variant for
// each combination of its values.
#pragma once

#include <string>
#include <vector>

#include "pipeline/rules/models.h"

namespace salbench {

// Names of the variant sections under `models`, in the file's order.
std::vector<std::string> variant_sections(const Section& models);

// Variants of a section. Those of a grid are named after the section and the options' values, separated by
// '-', with '_' for characters that names cannot have: LS-grid-0_05. Throws ConfigError.
std::vector<Model> variants_of(const std::string& name, const Section& models, Protocol protocol);

}  // namespace salbench
