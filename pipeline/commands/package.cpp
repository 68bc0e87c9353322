// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/package.h"

#include <cerrno>
#include <csignal>
#include <string>
#include <vector>

#include <unistd.h>

#include "io/file.h"
#include "pipeline/commands/subcommand.h"
#include "pipeline/package/package.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr PackageSubcommand kSubcommands[] = {
    {"conclude", "means, intervals, tests and ranks of scores per shape, of a run or of anybody's"},
    {"import", "write a data set in one form, an HDF5 file per shape and an index, which is the layout hdf5"},
    {"inspect",
     "read all files of a data set and print what its description finds: items, splits, ranges, problems"},
    {"submit", "check maps of your own and write the file that a leaderboard takes"},
    {"leaderboard", "check and score submissions, and make a site that ranks them"},
    {"report", "pages of a run that open from disk: who leads and how sure, figures, maps on the shapes"},
};

}  // namespace

std::span<const PackageSubcommand> package_subcommands() { return kSubcommands; }

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
