// SPDX-License-Identifier: GPL-3.0-or-later
// Files installed beside the program.
#pragma once

#include <filesystem>
#include <string>

namespace salbench {

// Path of a configuration: `given`, or if no such file exists the installed configuration of that name:
// "shrec07" is PREFIX/share/salbench/configs/shrec07.yaml for a program PREFIX/bin/salbench, or that of the
// checkout in which the program lies. Throws ConfigError if there is neither, and one of a similar name.
std::string configuration_path(const std::string& given);

// The folder of the Python package that was built or installed with the program, and of nothing else; empty
// where it is Debian's, which its interpreter finds anyway.
std::filesystem::path package_folder();

// The file that makes reports, from any folder: of the installation, or of the checkout that the program was
// built in; empty if neither is there.
std::filesystem::path report_program();

std::string report_command();  // that of the installation, or of the checkout

}  // namespace salbench
