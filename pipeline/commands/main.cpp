// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "pipeline/commands/standard_streams.h"
#include "pipeline/commands/subcommands.h"

int main(int argc, char** argv) {
  salbench::open_standard_streams();
  spdlog::set_default_logger(spdlog::stderr_color_mt("salbench"));
  spdlog::set_pattern("%^%l%$: %v");
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes then fails the write, as a full disk does
  return salbench::run_program(argc, argv, salbench::subcommand_rows());
}
