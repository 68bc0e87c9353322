// SPDX-License-Identifier: GPL-3.0-or-later
// The Python package of this version, as the program starts it: it lists and imports data sets, and draws
// conclusions.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace salbench {

// Exit status of what follows, after one line that says what to install, if the interpreter has no package of
// this version.
inline constexpr int kNoPackage = 69;  // EX_UNAVAILABLE of sysexits.h

// Its name for who installs it: as a package of Debian, or of a wheel as pip takes it.
std::string_view package_name();

// Words of a command that runs a subcommand of the package, with this exit status if there is none.
std::vector<std::string> package_words(int status_if_lacking, const std::vector<std::string>& words);

// The same as a line for /bin/sh.
std::string package_command(const std::vector<std::string>& words);

// The line of a command that ended with one of the shell's statuses for a program that it cannot start; empty
// for another status.
std::string no_interpreter(int status);
std::string no_interpreter(std::string_view reason);

// What is wrong with SALBENCH_PYTHON if it names a program that does not answer as Python does, which could
// end with status 0 and have done nothing; empty otherwise. One that cannot be started is left to who starts
// it.
std::string wrong_with_interpreter();

// Of a message of Python that says that a module is missing: "; /usr/bin/python3 has numpy"; empty of another
// one.
std::string who_has_module(std::string_view message);

// For a program that is a part of the package: the interpreter that it runs in, and where that found it.
void use_package(std::string interpreter, std::filesystem::path folder);

}  // namespace salbench
