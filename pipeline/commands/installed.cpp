#include "pipeline/commands/installed.h"

#include <filesystem>

namespace salbench {

namespace fs = std::filesystem;

std::string configuration_path(const std::string& given) {
  std::error_code error;
  if (fs::exists(given, error) || fs::path(given).has_parent_path()) return given;
  // The prefix is found from the program: a package is built for a prefix that it is not installed to yet.
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path folder = program.parent_path().parent_path() / "share/salbench/configs";
  for (const std::string& name : {given, given + ".yaml"})
    if (fs::is_regular_file(folder / name, error)) return (folder / name).string();
  return given;
}

}  // namespace salbench
