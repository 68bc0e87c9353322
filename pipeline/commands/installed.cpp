// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/installed.h"

#include <filesystem>

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Found from the program, since a package is built before its files are in their place. No such folder in a
// checkout.
fs::path share() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "share/salbench";
}

}  // namespace

std::string configuration_path(const std::string& given) {
  std::error_code error;
  if (fs::exists(given, error) || (fs::path(given).has_parent_path() && !given.starts_with("protocols/")))
    return given;
  for (const std::string& name : {given, given + ".yaml"})
    if (const fs::path path = share() / "configs" / name; fs::is_regular_file(path, error))
      return path.string();
  return given;
}

std::string report_command() {
  std::error_code error;
  return fs::is_directory(share() / "report", error) ? "salbench-report" : "scripts/report";
}

}  // namespace salbench
