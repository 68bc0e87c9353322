// SPDX-License-Identifier: GPL-3.0-or-later
// Variants of a built-in model: sections under `models` with a key `model`, such as {model: LS, foci_sigma:
// 0.08}. Options that they do not name are those of the section of their model. A section with a `grid`
// stands for a variant for each combination of its values.
#pragma once

#include <string>
#include <vector>

#include "pipeline/rules/models.h"

namespace salbench {

// Names of the sections under `models` that are variants, in the order of the file.
std::vector<std::string> variant_sections(const Section& models);

// The variants of a section. One of a grid has the name of the section and, behind '-' each, the values of
// its options, with '_' for whatever no name may have: LS-grid-0_05. Throws ConfigError.
std::vector<Model> variants_of(const std::string& name, const Section& models, Protocol protocol);

}  // namespace salbench
