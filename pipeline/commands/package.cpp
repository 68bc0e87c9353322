// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/package.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

#include "io/file.h"
#include "io/process.h"
#include "pipeline/commands/installed.h"
#include "pipeline/commands/subcommand.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr PackageSubcommand kSubcommands[] = {
    {"conclude", "means, intervals, tests and ranks of scores per shape, of a run or of anybody's"},
    {"power",
     "which differences between models the scores can show, and how many units would show those seen"},
    {"report", "pages of a run that open from disk: who leads and how sure, figures, maps on the shapes"},
};

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

std::string interpreter() {
  const char* chosen = std::getenv("SALBENCH_PYTHON");
  return chosen != nullptr && *chosen != '\0' ? chosen : SALBENCH_PYTHON;
}

std::string remedy() {
  std::string names;
  for (const PackageSubcommand& subcommand : kSubcommands)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", subcommand.name);
  return fmt::format(
      "install python3-salbench {}, or set SALBENCH_PYTHON to an interpreter that has it; without it, {} and "
      "all conclusions are missing, and everything else works",
      SALBENCH_VERSION, names);
}

std::vector<std::string> start(int status_if_lacking, std::span<const std::string> words) {
  std::vector<std::string> line = {interpreter(),
                                   "-P",
                                   "-c",
                                   kStart,
                                   SALBENCH_VERSION,
                                   package_folder().string(),
                                   std::to_string(status_if_lacking),
                                   remedy()};
  line.insert(line.end(), words.begin(), words.end());
  return line;
}

}  // namespace

std::span<const PackageSubcommand> package_subcommands() { return kSubcommands; }

std::string no_interpreter(std::string_view reason) {
  return fmt::format("{}: {}; {}", interpreter(), reason, remedy());
}

void become_package(std::span<const char* const> words) {
  std::vector<std::string> line =
      start(kUnusableArguments, std::vector<std::string>(words.begin(), words.end()));
  std::vector<char*> argv;
  for (std::string& word : line) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::signal(SIGXFSZ, SIG_DFL);  // what this program ignores is its own matter
  ::execvp(argv[0], argv.data());
  throw ConfigError(no_interpreter(system_reason(errno)));
}

std::string package_command(const std::vector<std::string>& words) {
  std::string command = "exec";
  for (const std::string& word : start(kNoPackage, words)) command += " " + shell_quoted(word);
  return command;
}

}  // namespace salbench
