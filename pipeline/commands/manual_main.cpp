// SPDX-License-Identifier: GPL-3.0-or-later
// salbench_manual page VERSION DATE | completion: prints what the build installs beside the program.
#include <string_view>

#include <fmt/format.h>

#include "pipeline/commands/manual.h"
#include "pipeline/commands/program.h"
#include "pipeline/commands/standard_streams.h"
#include "stages/core/errors.h"

namespace {

int print_document(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "page" && argc == 4) {
    fmt::print("{}", salbench::manual_page(salbench::subcommand_rows(), argv[2], argv[3]));
  } else if (what == "completion" && argc == 2) {
    fmt::print("{}", salbench::bash_completion(salbench::subcommand_rows()));
  } else {
    fmt::print(stderr, "usage: salbench_manual page VERSION DATE | completion\n");
    return salbench::kUnusableArguments;
  }
  return salbench::kAllDone;
}

}  // namespace

int main(int argc, char** argv) try {
  return salbench::print_all([&] { return print_document(argc, argv); });
} catch (const salbench::StorageError& error) {
  fmt::print(stderr, "{}\n", error.what());
  return salbench::kUnusableStorage;
}
