// SPDX-License-Identifier: GPL-3.0-or-later
// The table of subcommands, and the way from the command line to one of them.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/commands/process.h"
#include "io/refusal.h"
#include "pipeline/commands/commit.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/package.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/standard_streams.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/section.h"
#include "pipeline/package/package.h"
#include "pipeline/results/libraries.h"
#include "stages/core/errors.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

struct Example {
  std::string_view line, remark;  // behind `salbench`, the subcommand first

  bool is_of(std::string_view subcommand) const {
    return line.starts_with(subcommand) && line.substr(subcommand.size()).starts_with(' ');
  }
};

// Of each subcommand its help shows all, and the help of the program the first.
constexpr Example kExamples[] = {
    {"run configs/shrec07.yaml --data SchellingData", "the whole benchmark; run it again to resume"},
    {"run configs/shrec07.yaml --data SchellingData --items 1-20,52", "these, matched to the mean over all"},
    {"run configs/shrec07.yaml --data SchellingData --items scored", "all shapes that have ground truth"},
    {"run configs/shrec07.yaml --data SchellingData --shard 2/4", "the second of four shares"},
    {"run configs/shrec07_meshes.yaml --data SchellingData --maps mine --name MINE",
     "and your maps: mine/52.val"},
    {"run configs/shrec07_meshes.yaml --data SchellingData --maps mine.h5 --name MINE --models RS",
     "beside chance alone"},
    {"submit mine --to mine.zip --data SchellingData", "checked, and ready to be handed in"},
    {"leaderboard submissions --to site --data SchellingData", "site/index.html ranks those that pass"},
    {"export configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5",
     "all that is known of one shape"},
    {"export configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5 --pictures",
     "with pictures, for a report that shows shapes"},
    {"export configs/shrec07.yaml --data SchellingData --items 52 --to shapes --format ply", "for a viewer"},
    {"export configs/shrec07.yaml --data SchellingData --items 52 --models LS,PS --to maps --format maps",
     "maps/LS/52.val and others"},
    {"conclude results.csv --unit class --out tables", "with classes as observations"},
    {"report salbench-out/shrec07", "salbench-out/shrec07/report/index.html"},
    {"plan configs/shrec07.yaml --data SchellingData", "what a run would compute, why, and what it needs"},
    {"plan configs/shrec07.yaml --graph --format dot | dot -Tsvg", "the flow graph of a run, as a picture"},
    {"explain configs/shrec07.yaml 52_3 --data SchellingData", "what differs from what the cache has"},
    {"explain configs/shrec07.yaml 52 map.LS --data SchellingData", "one stage, and its artefact"},
    {"config", "every option, its default, unit and range"},
    {"config shrec07", "a configuration with all that it leaves out"},
    {"verify configs/shrec07.yaml --data SchellingData --deep", "read all, and compute 20 jobs again"},
    {"verify --cache salbench-cache", "read every artefact of a cache"},
    {"gc configs/shrec07.yaml --data SchellingData --dry-run", "what no run of it needs"},
    {"inspect 3dva --data 3DVA", "what a description finds in a folder"},
    {"import 3dva --data 3DVA --to 3DVA-hdf5", "the same set in one form, an HDF5 file per shape"},
};

constexpr const char* kExitStatus =
    R"(Exit status: 0 all done; 1 some items failed, each was named; 2 unusable arguments or configuration;
3 cache, output folder or standard output unusable; 70 a defect of the program, or memory ran out;
130 interrupted, the line that resumes was printed.)";

constexpr std::array kSubcommands = {
    run_subcommand,    export_subcommand, plan_subcommand, explain_subcommand,
    config_subcommand, verify_subcommand, gc_subcommand,
};

// Names of version 0.2, and what has taken their place.
struct FormerName {
  std::string_view name, line;
};
constexpr FormerName kFormerNames[] = {
    {"convert", "import LAYOUT --data DIR --to DIR2"},
    {"doctor", "plan CONFIG --data DIR"},
    {"evaluate", "run CONFIG --data DIR --maps MAPS --name NAME"},
    {"graph", "plan CONFIG --graph"},
    {"maps", "export CONFIG --data DIR --format maps --to MAPS"},
    {"pictures", "export CONFIG --data DIR --pictures --to FILE.h5"},
    {"power", "conclude OUT, which writes power.csv"},
    {"status", "plan CONFIG --data DIR"},
};

std::string command_line_of(std::span<const char* const> words) {
  std::string line;
  for (const char* word : words) line += (line.empty() ? "" : " ") + shell_quoted(word);
  return line;
}

std::string version_text() {
  return fmt::format("salbench {}\n{}instructions {}, {}", SALBENCH_VERSION,
                     commit().empty() ? "" : fmt::format("commit {}, ", commit()),
                     chi2_kernel::kernel().instructions, fmt::join(libraries(), ", "));
}

// A remark stands behind its line, or below one that is long.
std::string examples_of(const std::string& subcommand, bool all) {
  constexpr std::size_t kLine = 66;
  std::string text;
  for (const Example& example : kExamples) {
    if (!example.is_of(subcommand) && example.line != subcommand) continue;
    text += example.line.size() > kLine
                ? fmt::format("  salbench {}\n{:{}}{}\n", example.line, "", kLine + 13, example.remark)
                : fmt::format("  salbench {:<{}}  {}\n", example.line, kLine, example.remark);
    if (!all) break;
  }
  return text;
}

bool is_of_package(std::string_view name) {
  return std::ranges::find(package_subcommands(), name, &PackageSubcommand::name) !=
         package_subcommands().end();
}

// What is wrong with a line that names an unknown subcommand or option; empty if nothing of the kind.
std::string unknown_word(const CLI::App& app, std::span<const char* const> words,
                         const std::vector<Subcommand>& subcommands) {
  std::vector<std::string_view> known;
  for (const Subcommand& subcommand : subcommands) {
    known.emplace_back(subcommand.name);
    if (!app.got_subcommand(subcommand.name)) continue;
    std::vector<std::string_view> options;
    for (const Parameter& parameter : subcommand.parameters) options.emplace_back(parameter.name);
    for (const std::string& extra : app.get_subcommand(subcommand.name)->remaining())
      if (extra.starts_with("--"))
        return fmt::format("{}: there is no option '{}'; {}", subcommand.name, extra,
                           did_you_mean(extra.substr(0, extra.find('=')), options,
                                        fmt::format("salbench {} --help names them", subcommand.name)));
    return {};
  }
  for (const PackageSubcommand& subcommand : package_subcommands()) known.push_back(subcommand.name);
  if (words.size() < 2 || std::string_view(words[1]).starts_with("-")) return {};
  return fmt::format("there is no subcommand '{}'; {}", words[1],
                     did_you_mean(words[1], known, "salbench --help names them"));
}

struct Declare {
  CLI::App& app;
  const Parameter& parameter;

  void operator()(bool* target) const { app.add_flag(parameter.name, *target, parameter.help); }
  void operator()(int* target) const { declared(*target)->check(CLI::Range(1, parameter.max)); }
  void operator()(std::optional<std::string>* target) const {  // an empty text is one
    app.add_option_function<std::string>(
        parameter.name, [target](const std::string& text) { *target = text; }, parameter.help);
  }
  template <class Text>
  void operator()(Text* target) const {
    declared(*target);
  }

 private:
  template <class Target>
  CLI::Option* declared(Target& target) const {
    CLI::Option* option =
        app.add_option(parameter.name, target, parameter.help)->required(parameter.required);
    return parameter.is_path ? option->check(named) : option;
  }
  static std::string named(const std::string& path) {
    return path.empty() ? "is empty: name a file or a folder" : std::string();
  }
};

int dispatch(std::span<const char* const> words, std::span<const SubcommandRow> rows) {
  CLI::App app{"Benchmark of 3D saliency models on meshes, simulated range scans and point clouds."};
  app.set_version_flag("--version", version_text);
  app.require_subcommand(1);
  if (words.size() > 1 && is_of_package(words[1])) become_package(words.subspan(1));
  for (const auto& [name, line] : kFormerNames)
    if (words.size() > 1 && name == words[1])
      throw ConfigError(fmt::format("there is no {} any more: salbench {}", name, line));
  Arguments arguments;
  arguments.command_line = command_line_of(words);
  std::string examples;
  std::vector<Subcommand> subcommands;
  for (const SubcommandRow row : rows) subcommands.push_back(row(arguments));
  for (const Subcommand& subcommand : subcommands) {
    CLI::App* declared = app.add_subcommand(subcommand.name, subcommand.summary);
    declared->footer("Examples:\n" + examples_of(subcommand.name, true));
    examples += examples_of(subcommand.name, false);
    for (const Parameter& parameter : subcommand.parameters)
      std::visit(Declare{*declared, parameter}, parameter.target);
    for (const Parameter& parameter : subcommand.parameters)
      if (!parameter.needs.empty())
        declared->get_option(parameter.name)->needs(declared->get_option(parameter.needs));
  }
  std::string of_package;
  for (const auto& [name, summary] : package_subcommands()) {
    of_package += fmt::format("  {:<26}  {}\n", name, summary);
    examples += examples_of(std::string(name), false);
  }
  app.footer(fmt::format("Subcommands of the Python package ({}):\n{}\nExamples:\n{}\n{}", package_name(),
                         of_package, examples, kExitStatus));
  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::ParseError& error) {
    if (const std::string wrong = unknown_word(app, words, subcommands);
        error.get_exit_code() != 0 && !wrong.empty())
      throw ConfigError(wrong);
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
  } catch (const std::system_error& error) {
    spdlog::error("{}", text_of(error));
    return kUnusableStorage;
  } catch (const std::bad_alloc&) {
    spdlog::error("{}", current_defect());
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
