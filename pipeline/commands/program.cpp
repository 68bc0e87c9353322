// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/program.h"

#include <array>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/commands/help.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/standard_streams.h"
#include "pipeline/commands/subcommands.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::array kSubcommands = {
    run_subcommand,         maps_subcommand,   evaluate_subcommand, pictures_subcommand, export_subcommand,
    conclusions_subcommand, power_subcommand,  plan_subcommand,     graph_subcommand,    explain_subcommand,
    status_subcommand,      config_subcommand, verify_subcommand,   gc_subcommand,
};

std::string joined(std::span<const char* const> words) {
  std::string line;
  for (const char* word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

struct Declare {
  CLI::App& app;
  const Parameter& parameter;

  void operator()(bool* target) const { app.add_flag(parameter.name, *target, parameter.help); }
  void operator()(int* target) const { declared(*target)->check(CLI::Range(1, parameter.max)); }
  template <class Text>
  void operator()(Text* target) const {
    declared(*target);
  }

 private:
  template <class Target>
  CLI::Option* declared(Target& target) const {
    return app.add_option(parameter.name, target, parameter.help)->required(parameter.required);
  }
};

int dispatch(std::span<const char* const> words, std::span<const SubcommandRow> rows) {
  CLI::App app{kDescription};
  app.set_version_flag("--version", "salbench " SALBENCH_VERSION);
  app.footer(help_footer());
  app.require_subcommand(1);
  Arguments arguments;
  arguments.command_line = joined(words);
  std::vector<Subcommand> subcommands;
  for (const SubcommandRow row : rows) subcommands.push_back(row(arguments));
  for (const Subcommand& subcommand : subcommands) {
    CLI::App* declared = app.add_subcommand(subcommand.name, subcommand.summary);
    for (const Parameter& parameter : subcommand.parameters)
      std::visit(Declare{*declared, parameter}, parameter.target);
  }
  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::ParseError& error) {
    std::ostringstream help;  // printed by what reports an output that cannot be written to
    const int status = app.exit(error, help, std::cerr);
    fmt::print("{}", help.str());
    return status == 0 ? kAllDone : kUnusableArguments;
  }
  handle_interrupts(interrupted_text(arguments));
  for (const Subcommand& subcommand : subcommands)
    if (app.got_subcommand(subcommand.name)) return subcommand.run(interrupted());
  throw std::logic_error("a subcommand was parsed that is not in the table");
}

}  // namespace

std::span<const SubcommandRow> subcommand_rows() { return kSubcommands; }

int run_program(int argc, const char* const* argv, std::span<const SubcommandRow> rows) {
  try {
    return print_all([&] { return dispatch({argv, static_cast<std::size_t>(argc)}, rows); });
  } catch (const StorageError& error) {
    spdlog::error("{}", error.what());
    return kUnusableStorage;
  } catch (const std::filesystem::filesystem_error& error) {
    spdlog::error("{}: {}", error.path1().string(), system_reason(error.code().value()));
    return kUnusableStorage;
  } catch (const ConfigError& error) {
    spdlog::error("{}", error.what());
    return kUnusableArguments;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kUnusableArguments;
  } catch (...) {
    spdlog::error("{}", current_defect());
    return kDefect;
  }
}

}  // namespace salbench
