// SPDX-License-Identifier: GPL-3.0-or-later
// Configurations that are a part of the program, and files installed beside it.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/config/section.h"

namespace salbench {

// The configuration in a file, or if no such file exists that of the program of this name: "shrec07",
// "protocols/3dva". Throws ConfigError if there is neither, with the nearest name.
Section configuration(const std::string& given);

// The folder of the Python package that was built or installed with the program, and of nothing else; empty
// where it is Debian's, which its interpreter finds anyway.
std::filesystem::path package_folder();

}  // namespace salbench
