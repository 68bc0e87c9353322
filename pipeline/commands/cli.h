// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: the command line. Words come in; a subcommand, its output and its exit status go out.
// session.h is the way from their arguments to a run. It includes everything, and alone CLI11; nothing
// includes it.
#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"

namespace salbench {

// Carries out a subcommand whose arguments have been parsed. Throws ConfigError, InputError or StorageError
// for what makes the whole command impossible.
using Action = std::function<ExitStatus()>;
using Subcommand = Action (*)(CLI::App& program);  // adds itself and its words to the program

// Who calls each subcommand, and when. `salbench NAME --help` says what it does.
//
// Everybody: the benchmark of a configuration, and again after any change or interruption. Authors of a model
// whose maps are made already: its scores beside the others'.
Action run_subcommand(CLI::App& program);
// Whoever goes on in Python or a viewer, or archives a study: when the run is done.
Action export_subcommand(CLI::App& program);
// Before a long run, to see what it would compute and why; during one, from another terminal. Whoever sees
// more computed than expected: one item. Whoever changes the table of rules: its graph.
Action plan_subcommand(CLI::App& program);
// Whoever writes a configuration, for what there is to choose.
Action config_subcommand(CLI::App& program);
// Owners of a cache, after trouble with a disk, and before results are published.
Action verify_subcommand(CLI::App& program);
// Owners of a cache, when the disk fills up.
Action gc_subcommand(CLI::App& program);

inline constexpr std::array<Subcommand, 6> kSubcommands = {
    run_subcommand, export_subcommand, plan_subcommand, config_subcommand, verify_subcommand, gc_subcommand};

// --- for their files --------------------------------------------------------------------------------------

struct Example {
  std::string_view line, remark;  // behind `salbench`, the subcommand first
};

// With examples below its help; the help of the program has the first.
CLI::App& add_subcommand(CLI::App& program, const std::string& name, const std::string& summary,
                         std::initializer_list<Example> examples);

extern const CLI::Validator kPath;  // of a file or a folder: an empty one would be the present folder

// An option whose value is one of some words, of which there are several.
void add_choice(CLI::App& app, const std::string& name, std::string& chosen,
                const std::vector<std::string>& known, const std::string& help);

// Options that several subcommands share.
CLI::Option* add_config(CLI::App& app, Arguments& arguments);
CLI::Option* add_output(CLI::App& app, Arguments& arguments);
void add_shard(CLI::App& app, Arguments& arguments);
void add_format(CLI::App& app, Arguments& arguments,
                const std::vector<std::string>& formats = {"text", "json"},
                const std::string& further_help = "");
void add_data_set(CLI::App& app, Arguments& arguments);  // --data and --cache, --items, --split, --reference
void add_given_maps(CLI::App& app, Arguments& arguments,
                    const std::string& help);            // --maps, --name, --matched
void add_planning(CLI::App& app, Arguments& arguments);  // CONFIG and these: what a run is made of
void add_running(CLI::App& app, Arguments& arguments);   // --threads and --quiet beside these

// --- the program ------------------------------------------------------------------------------------------

// Adds the subcommands, in their order, and behind them those of the Python package.
std::vector<Action> declare_program(CLI::App& program, std::span<const Subcommand> subcommands);

void add_package(CLI::App& program);
bool is_of_package(std::string_view subcommand);
// Turns this process into the package's, so that signals and exit status are its own. The words are those
// behind the program's name. Throws ConfigError if there is no interpreter.
[[noreturn]] void become_package(std::span<const char* const> words);

// From the command line to a subcommand and its exit status. Every error is said on standard error, and every
// way to end is an ExitStatus. An output that cannot be written to its end is an error.
int run_program(int argc, const char* const* argv, std::span<const Subcommand> subcommands = kSubcommands);

}  // namespace salbench
