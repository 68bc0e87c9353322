// SPDX-License-Identifier: GPL-3.0-or-later
// The table of subcommands, and the way from the command line to one of them.
#include <array>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/standard_streams.h"
#include "pipeline/commands/subcommands.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr const char* kFooter =
    R"(Examples:
  salbench run configs/shrec07.yaml --data SchellingData            the whole benchmark; run it again to resume
  salbench run configs/shrec07.yaml --data SchellingData --items 1-20,52,125
  salbench maps configs/shrec07.yaml --data SchellingData --items 52 --models LS,PS --to maps
  salbench pictures configs/shrec07.yaml --data SchellingData --items 52
  salbench export configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5
  salbench plan configs/shrec07.yaml --data SchellingData           what a run would compute, and why
  salbench graph configs/shrec07.yaml --format dot | dot -Tsvg      the flow graph of a run, as a picture
  salbench explain configs/shrec07.yaml 52_3 --data SchellingData   what differs from what the cache has
  salbench status configs/shrec07.yaml --data SchellingData         what is there already
  salbench doctor configs/shrec07.yaml --data SchellingData         whether machine and disk are fit for it
  salbench inspect 3dva --data 3DVA                                 what a description finds in a folder
  salbench convert 3dva --data 3DVA --to 3DVA-hdf5                  the same set in one form, an HDF5 file per shape
  salbench config                                                   every option, its default, unit and range

Exit status: 0 all done; 1 some items failed, each was named; 2 unusable arguments or configuration;
3 cache, output folder or standard output unusable; 70 a defect of the program, or memory ran out;
130 interrupted, the line that resumes was printed.)";

constexpr std::array kSubcommands = {
    run_subcommand,         maps_subcommand,    evaluate_subcommand, pictures_subcommand, export_subcommand,
    conclusions_subcommand, power_subcommand,   plan_subcommand,     graph_subcommand,    explain_subcommand,
    status_subcommand,      doctor_subcommand,  config_subcommand,   verify_subcommand,   gc_subcommand,
    inspect_subcommand,     convert_subcommand,
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
  CLI::App app{"Benchmark of 3D saliency models on meshes, simulated range scans and point clouds."};
  app.set_version_flag("--version", "salbench " SALBENCH_VERSION);
  app.footer(kFooter);
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
