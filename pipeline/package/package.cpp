// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/package/package.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <sys/wait.h>

#include "io/commands/process.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Arguments: version, folder of the package or nothing, status if it is lacking, what to do then, words. No
// variable of the environment is set: what the package starts finds the user's own.
constexpr const char* kStart = R"py(import sys
version, folder, status, remedy, *words = sys.argv[1:]
if folder:
    sys.path.insert(0, folder)
def lacking(what):
    print(f"error: {sys.executable}: {what}; {remedy}", file=sys.stderr)
    sys.exit(int(status))
try:
    import salbench
    found = salbench.__version__
except (ImportError, AttributeError) as error:
    lacking(f"the Python package of salbench cannot be used: {error}")
if found != version:
    lacking(f"its package salbench is {found} ({salbench.__file__}), but the program is {version}")
sys.argv = ["salbench", *words]
try:
    from salbench.__main__ import main
    sys.exit(main())
except ModuleNotFoundError as error:
    if (error.name or "").startswith("salbench.") and error.name != "salbench.__main__":
        raise
    lacking(f"there is no module {error.name}")
)py";

struct Package {
  std::string interpreter;
  fs::path folder;
};

std::optional<Package>& around_us() {
  static std::optional<Package> package;
  return package;
}

std::string interpreter() {
  if (const auto& package = around_us()) return package->interpreter;
  const char* chosen = std::getenv("SALBENCH_PYTHON");
  return chosen != nullptr && *chosen != '\0' ? chosen : SALBENCH_PYTHON;
}

std::string remedy() {
  return fmt::format(
      "install {} {}, or set SALBENCH_PYTHON to an interpreter that has it; without it, data sets are "
      "those of the layouts schelling, folder and hdf5, and end with scores and their means",
      package_name(), SALBENCH_VERSION);
}

// To look for the package in: beside the program, in the tree that it was built or installed in; empty where
// the interpreter finds it by itself.
fs::path package_folder() {
  if (const auto& package = around_us()) return package->folder;
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (fs::path folder : {bin / "python", bin.parent_path() / "lib/python3/dist-packages"})
    if (folder.parent_path() != "/usr/lib/python3" && fs::is_directory(folder / "salbench", error))
      return folder;
  return {};
}

// Those on the PATH, and the package's own.
std::vector<std::string> interpreters() {
  std::vector<std::string> all = {interpreter()};
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / "python3";
    std::error_code missing;
    if (file.is_absolute() && fs::is_regular_file(file, missing)) all.push_back(file.string());
  }
  return all;
}

std::string interpreter_with(const std::string& module) {
  const std::string look =
      fmt::format("import importlib.util as u, sys; sys.exit(u.find_spec('{}') is None)", module);
  for (const std::string& python : interpreters()) try {
      const std::string line = fmt::format("exec {} -c {}", shell_quoted(python), shell_quoted(look));
      if (try_command(line, fs::temp_directory_path(), std::chrono::seconds(30)).status == 0)
        return fmt::format("; {} has {}: start the command with it", python, module);
    } catch (const InputError&) {  // it takes too long
    }
  return fmt::format("; no python3 on the PATH has {}", module);
}

}  // namespace

std::string_view package_name() { return SALBENCH_PACKAGE; }

std::string who_has_module(std::string_view message) {
  constexpr std::string_view kMissing = "No module named '";
  const std::size_t at = message.find(kMissing);
  if (at == std::string_view::npos) return {};
  std::string_view name = message.substr(at + kMissing.size());
  name = name.substr(0, name.find_first_of("'."));
  const auto is_of_name = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  if (name.empty() || !std::ranges::all_of(name, is_of_name)) return {};
  static std::mutex asking;
  static std::map<std::string, std::string, std::less<>> known;  // by module
  const std::lock_guard lock(asking);
  const auto found = known.find(name);
  return found != known.end() ? found->second
                              : known.emplace(name, interpreter_with(std::string(name))).first->second;
}

void use_package(std::string interpreter, fs::path folder) {
  around_us() = {std::move(interpreter), std::move(folder)};
}

std::vector<std::string> package_words(int status_if_lacking, const std::vector<std::string>& words) {
  std::vector<std::string> line = {interpreter(),
                                   "-P",
                                   "-X",
                                   "utf8",  // names and texts are read and written as the program does
                                   "-c",
                                   kStart,
                                   SALBENCH_VERSION,
                                   package_folder().string(),
                                   std::to_string(status_if_lacking),
                                   remedy()};
  line.insert(line.end(), words.begin(), words.end());
  return line;
}

std::string wrong_with_interpreter() {
  constexpr std::string_view kAnswer = "salbench 42\n";
  if (around_us() || interpreter() == SALBENCH_PYTHON) return {};
  const std::string question =
      shell_quoted(interpreter()) + " -I -S -c 'print(\"salbench\", 6 * 7)' 2>/dev/null";
  std::FILE* const asked = ::popen(question.c_str(), "r");
  if (asked == nullptr) return {};
  std::array<char, 64> answer{};
  const std::size_t size = std::fread(answer.data(), 1, answer.size(), asked);
  const int status = ::pclose(asked);
  const bool is_left = WIFEXITED(status) && !no_interpreter(WEXITSTATUS(status)).empty();
  return is_left || std::string_view(answer.data(), size) == kAnswer ? "" : no_interpreter("is no Python");
}

std::string package_command(const std::vector<std::string>& words) {
  std::string command = "exec";
  for (const std::string& word : package_words(kNoPackage, words)) command += " " + shell_quoted(word);
  return command;
}

std::string no_interpreter(std::string_view reason) {
  return fmt::format("{}: {}; {}", interpreter(), reason, remedy());
}

std::string no_interpreter(int status) {
  constexpr int kNotExecutable = 126, kNotFound = 127;  // as the shell says it of a program
  if (status == kNotFound) return no_interpreter("not found");
  return status == kNotExecutable ? no_interpreter("cannot be executed") : std::string();
}

}  // namespace salbench
