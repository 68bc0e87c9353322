// SPDX-License-Identifier: GPL-3.0-or-later
// Files installed beside the program.
#pragma once

#include <string>

namespace salbench {

// Path of a configuration: `given`, or if no such file exists the installed configuration of that name:
// "shrec07" is PREFIX/share/salbench/configs/shrec07.yaml for a program PREFIX/bin/salbench.
std::string configuration_path(const std::string& given);

std::string report_command();  // that of the installation, or of the checkout

}  // namespace salbench
