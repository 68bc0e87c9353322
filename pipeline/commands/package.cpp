// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommands of the Python package, which the program hands over.
#include "pipeline/package/package.h"

#include <algorithm>
#include <cerrno>
#include <csignal>

#include <fmt/format.h>
#include <unistd.h>

#include "io/file.h"
#include "pipeline/commands/cli.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// THE list of them; a test compares it with that of the package (python/salbench/__main__.py).
struct PackageSubcommand {
  const char *name, *summary;
  Example example;
};
constexpr PackageSubcommand kOfPackage[] = {
    {"conclude",
     "means, intervals, tests and ranks of scores per shape, of a run or of anybody's",
     {"conclude results.csv --unit class --out tables", "with classes as observations"}},
    {"import",
     "write a data set in one form, an HDF5 file per shape and an index, which is the layout hdf5",
     {"import 3dva --data 3DVA --to 3DVA-hdf5", "the same set in one form, an HDF5 file per shape"}},
    {"inspect",
     "read all files of a data set and print what its description finds: items, splits, ranges, problems",
     {"inspect 3dva --data 3DVA", "what a description finds in a folder"}},
    {"submit",
     "check maps of your own and write the file that a leaderboard takes",
     {"submit mine --to mine.zip --data SchellingData", "checked, and ready to be handed in"}},
    {"leaderboard",
     "check and score submissions, and make a site that ranks them",
     {"leaderboard submissions --to site --data SchellingData", "site/index.html ranks those that pass"}},
    {"reproduce",
     "make the maps of a submission again, by the command of its card, and say how near they come",
     {"reproduce mine.zip --model mine --data SchellingData", "code and weights are in the folder mine"}},
    {"report",
     "pages of a run that open from disk: who leads and how sure, figures, maps on the shapes",
     {"report salbench-out/shrec07", "salbench-out/shrec07/report/index.html"}},
};

}  // namespace

void add_package(CLI::App& program) {
  for (const auto& [name, summary, example] : kOfPackage)
    add_subcommand(program, name, summary, {example})
        .group(fmt::format("Subcommands of the Python package ({})", package_name()));
}

bool is_of_package(std::string_view subcommand) {
  return std::ranges::find(kOfPackage, subcommand, &PackageSubcommand::name) != std::end(kOfPackage);
}

void become_package(std::span<const char* const> words) {
  std::vector<std::string> line =
      package_words(kUnusableArguments, std::vector<std::string>(words.begin(), words.end()));
  // Python ignores SIGPIPE and forgets whether it was to end the program.
  if (std::signal(SIGPIPE, SIG_IGN) == SIG_IGN)
    line.insert(line.begin() + 1, {"-X", "broken_pipe_is_an_error"});
  std::vector<char*> argv;
  for (std::string& word : line) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (const std::string wrong = wrong_with_interpreter(); !wrong.empty()) throw ConfigError(wrong);
  std::signal(SIGXFSZ, SIG_DFL);  // what this program ignores is its own matter
  // Until the package has handlers (raise_interrupts): Python would end in a traceback of whatever it
  // imports.
  sigset_t interrupts, before;
  ::sigemptyset(&interrupts);
  ::sigaddset(&interrupts, SIGINT);
  ::sigprocmask(SIG_BLOCK, &interrupts, &before);
  ::execvp(argv[0], argv.data());
  const int error = errno;
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  throw ConfigError(no_interpreter(system_reason(error)));
}

}  // namespace salbench
