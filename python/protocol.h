// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pipeline/rules/config.h"

namespace salbench::python {

// The configuration without models, folders and pictures: what makes scores of the same maps the same.
std::string protocol_text(Config config);

}  // namespace salbench::python
