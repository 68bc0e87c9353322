// SPDX-License-Identifier: GPL-3.0-or-later
// A subcommand of the program: its name, its parameters and what it does. It knows no command-line library.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace salbench {

enum ExitStatus {
  kAllDone = 0,
  kSomeFailed = 1,
  kUnusableArguments = 2,  // or configuration
  kUnusableStorage =
      3,  // cache, output folder or standard output; or the system has no memory or thread to begin with
  kDefect = 70,  // of the program, or memory ran out in a job; as in sysexits.h
  kInterrupted = 130,
};

// Arguments that several subcommands share; empty or 0 if the command line does not give them.
struct Arguments {
  std::string command_line;  // as typed: the line that resumes
  std::string config;
  std::string data, cache, output;
  std::string items;                 // "1-20,52,125", "scored"
  std::optional<std::string> split;  // "test"; "": all items, whatever the configuration takes
  std::string shard;                 // "2/4"
  std::string reference;             // CSV file with a reference histogram in column GS, or kReferenceOfItems
  std::string models;                // "LS,PS"; empty: all of the configuration
  std::string to;                    // what is written to
  int threads = 0;                   // 0: all cores
  bool quiet = false;                // no progress, no table
};

inline constexpr int kMostThreads = 1024;  // that anybody may ask for, here and in the package

inline constexpr std::string_view kReferenceOfItems = "items";  // in place of a file

struct Parameter {
  std::string name;  // "--items", or "ITEM" for one that is known by its place
  std::variant<std::string*, std::optional<std::string>*, std::vector<std::string>*, int*, bool*> target;
  std::string help;
  bool required = false;
  int max = std::numeric_limits<int>::max();  // of a number, which is at least 1
  std::string needs = {};                     // name of another one without which this one would do nothing
  bool is_path = false;                       // an empty text is refused: it would be the present folder
};
using Parameters = std::vector<Parameter>;

struct Subcommand {
  std::string name, summary;
  Parameters parameters;
  // Throws ConfigError, InputError or StorageError for what makes the whole command impossible.
  std::function<ExitStatus(const std::atomic<bool>& stop)> run;
};

// A row of the table of subcommands. `arguments` is filled before `run` is called, and outlives it.
using SubcommandRow = Subcommand (*)(Arguments& arguments);

Parameter of_path(Parameter parameter);  // the same for a file or a folder

// Parameters that several subcommands share.
Parameter config_parameter(Arguments& arguments);
Parameter shard_parameter(Arguments& arguments);
Parameter data_parameter(Arguments& arguments);
Parameter output_parameter(Arguments& arguments);
Parameter threads_parameter(Arguments& arguments);

Parameters selecting_parameters(Arguments& arguments);  // --items, --split, --reference
// CONFIG, --data, --cache and these: what a run is made of.
Parameters planning_parameters(Arguments& arguments, const Parameters& further = {});
// --threads and --quiet beside these: of what computes.
Parameters running_parameters(Arguments& arguments, const Parameters& further = {});
// --data, --cache, those that select, and --quiet: of what looks after a cache.
Parameters maintaining_parameters(Arguments& arguments, const Parameters& further = {});

// Parameters of which some do nothing unless `needed` is given, too; and those without some.
Parameters needing(Parameters parameters, const std::string& needed, const std::vector<std::string>& names);
Parameters without(Parameters parameters, const std::vector<std::string>& names);

}  // namespace salbench
