// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the command line to a subcommand, and what several of them share.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "io/commands/process.h"
#include "io/file.h"
#include "io/refusal.h"
#include "pipeline/commands/cli.h"
#include "pipeline/commands/commit.h"
#include "pipeline/commands/report.h"
#include "pipeline/config/section.h"
#include "pipeline/results/record.h"
#include "stages/core/errors.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

constexpr const char* kExitStatus =
    R"(Exit status: 0 all done; 1 some items failed, each was named; 2 unusable arguments or configuration;
3 cache, output folder or standard output unusable; 70 a defect of the program, or memory ran out;
130 interrupted, the line that resumes was printed.)";

constexpr std::string_view kExamples = "Examples:\n";

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
std::string example_text(const Example& example) {
  constexpr std::size_t kLine = 66;
  return example.line.size() > kLine
             ? fmt::format("  salbench {}\n{:{}}{}\n", example.line, "", kLine + 13, example.remark)
             : fmt::format("  salbench {:<{}}  {}\n", example.line, kLine, example.remark);
}

std::string first_example(const CLI::App& subcommand) {
  const std::string footer = subcommand.get_footer();
  const std::size_t second = footer.find("\n  salbench ", kExamples.size());
  return footer.substr(kExamples.size(), second - kExamples.size()) + (second < footer.size() ? "\n" : "");
}

// What is wrong with a line that names an unknown subcommand, or an unknown option of a subcommand; empty if
// nothing of the kind.
std::string unknown_word(const CLI::App& program) {
  const auto parsed = program.get_subcommands();
  const bool in_program = parsed.empty();
  const CLI::App& app = in_program ? program : *parsed[0];
  std::vector<std::string> known;
  for (const CLI::App* subcommand : app.get_subcommands({})) known.push_back(subcommand->get_name());
  for (const CLI::Option* option : app.get_options())
    if (!in_program && option != app.get_help_ptr()) known.push_back(option->get_name());
  for (const std::string& word : app.remaining()) {
    if (word.starts_with(in_program ? "-" : "--") == in_program) continue;
    const std::string hint =
        did_you_mean(word.substr(0, word.find('=')), {known.begin(), known.end()},
                     fmt::format("salbench {}--help names them", in_program ? "" : app.get_name() + " "));
    return in_program ? fmt::format("there is no subcommand '{}'; {}", word, hint)
                      : fmt::format("{}: there is no option '{}'; {}", app.get_name(), word, hint);
  }
  return {};
}

int dispatch(std::span<const char* const> words, std::span<const Subcommand> subcommands) {
  const std::string_view first = words.size() > 1 ? words[1] : "";
  if (is_of_package(first)) become_package(words.subspan(1));
  for (const auto& [name, line] : kFormerNames)
    if (name == first) throw ConfigError(fmt::format("there is no {} any more: salbench {}", name, line));
  CLI::App program;
  const std::vector<Action> actions = declare_program(program, subcommands);
  try {
    program.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::ParseError& error) {
    if (const std::string wrong = unknown_word(program); error.get_exit_code() != 0 && !wrong.empty())
      throw ConfigError(wrong);
    std::ostringstream help;  // printed by what reports an output that cannot be written to
    const int status = program.exit(error, help, std::cerr);
    fmt::print("{}", help.str());
    return status == 0 ? kAllDone : kUnusableArguments;
  }
  handle_interrupts(command_line_of(words));
  const auto declared = program.get_subcommands({});
  for (std::size_t i = 0; i < actions.size(); ++i)
    if (declared[i]->parsed()) return actions[i]();
  throw std::logic_error("a subcommand was parsed that is not in the table");
}

// Whether all that was printed is stored; a network file system says at a close what it could not store.
bool flush_output() {
  if (std::fflush(stdout) != 0) return false;
  const int copy = ::dup(STDOUT_FILENO);
  return copy < 0 || ::close(copy) == 0;
}

std::string no_output(int error) {
  return fmt::format("standard output: cannot be written to: {}",
                     error == EBADF ? "it is closed" : system_reason(error));
}

}  // namespace

std::vector<Action> declare_program(CLI::App& program, std::span<const Subcommand> subcommands) {
  program.description("Benchmark of 3D saliency models on meshes, simulated range scans and point clouds.");
  program.set_version_flag("--version", version_text);
  program.require_subcommand(1);
  std::vector<Action> actions;
  for (const Subcommand subcommand : subcommands) actions.push_back(subcommand(program));
  add_package(program);
  std::string examples;
  for (const CLI::App* subcommand : program.get_subcommands({})) examples += first_example(*subcommand);
  program.footer(fmt::format("{}{}\n{}", kExamples, examples, kExitStatus));
  return actions;
}

CLI::App& add_subcommand(CLI::App& program, const std::string& name, const std::string& summary,
                         std::initializer_list<Example> examples) {
  CLI::App* app = program.add_subcommand(name, summary);
  std::string footer(kExamples);
  for (const Example& example : examples) footer += example_text(example);
  app->footer(footer);
  return *app;
}

const CLI::Validator kPath(
    [](const std::string& path) {
      return path.empty() ? "is empty: name a file or a folder" : std::string();
    },
    "");

CLI::Option* add_config(CLI::App& app, Arguments& arguments) {
  return app
      .add_option(
          "CONFIG", arguments.config,
          "configuration file (YAML), run.yaml of a run (its configuration and items), or the name of an "
          "installed one, such as shrec07")
      ->check(kPath)
      ->required();
}

CLI::Option* add_output(CLI::App& app, Arguments& arguments) {
  return app
      .add_option("--out", arguments.output,
                  "folder of the results (default: output in CONFIG, or salbench-out/NAME)")
      ->check(kPath);
}

void add_shard(CLI::App& app, Arguments& arguments) {
  app.add_option("--shard", arguments.shard,
                 "only share I of N of the items, as I/N; a run without it then merges the shares");
}

void add_choice(CLI::App& app, const std::string& name, std::string& chosen,
                const std::vector<std::string>& known, const std::string& help) {
  app.add_option(name, chosen, help)->check([=](const std::string& word) {
    if (std::ranges::find(known, word) == known.end())
      throw ConfigError(fmt::format("{} {}: must be {}{}{}", name, word,
                                    fmt::join(known.begin(), known.end() - 1, ", "),
                                    known.size() > 1 ? " or " : "", known.back()));
    return std::string();
  });
}

void add_format(CLI::App& app, Arguments& arguments, const std::vector<std::string>& formats,
                const std::string& further_help) {
  add_choice(app, "--format", arguments.format, formats,
             "text (default), or json: one document for programs (docs/json.md)" + further_help);
}

void add_data_set(CLI::App& app, Arguments& arguments) {
  app.add_option("--data", arguments.data, "folder of the data set")->check(kPath);
  app.add_option("--cache", arguments.cache,
                 "folder of the artefacts (default: cache in CONFIG, or salbench-cache)")
      ->check(kPath);
  app.add_option("--items", arguments.items,
                 "only these shapes and their scans, such as 1-20,52,125, or scored: all with ground truth");
  // CLI11 makes nothing of an empty text for an optional.
  app.add_option_function<std::string>(
      "--split", [&arguments](const std::string& split) { arguments.split = split; },
      "only this split of the data set, such as test; '': all, where CONFIG names one");
  app.add_option("--reference", arguments.reference,
                 "match to this histogram (CSV with a column GS of 100 bins), not to the mean over the data "
                 "set; items: to the mean over --items")
      ->check(kPath);
}

void add_given_maps(CLI::App& app, Arguments& arguments, const std::string& help) {
  CLI::Option* maps = app.add_option("--maps", arguments.maps, help);
  CLI::Option* name = app.add_option("--name", arguments.name, "what to call them in the tables");
  app.add_flag("--matched", arguments.matched, "their values are histogram-matched already")->needs(maps);
  maps->check(kPath)->needs(name);
  name->needs(maps);
}

void add_planning(CLI::App& app, Arguments& arguments) {
  add_config(app, arguments);
  add_data_set(app, arguments);
}

void add_running(CLI::App& app, Arguments& arguments) {
  add_planning(app, arguments);
  app.add_option("--threads", arguments.threads, "threads (default: all cores); results do not depend on it")
      ->check(CLI::Range(1, kMostThreads));
  app.add_flag("--keep-going", arguments.keep_going,
               "try a command or function that fails alike on its first five shapes on all others, too");
  app.add_flag("--quiet", arguments.quiet, "neither progress nor tables; warnings and errors only");
}

void print_report(const std::string& format, const std::string& subcommand, const Json& members,
                  const std::string& text) {
  if (format != "json") return fmt::print("{}", text);
  Json document = {{"schema", kReportSchema}, {"command", subcommand}};
  document.update(members);
  // U+FFFD in place of bytes that are not UTF-8.
  fmt::print("{}\n", document.dump(-1, ' ', false, Json::error_handler_t::replace));
}

int run_program(int argc, const char* const* argv, std::span<const Subcommand> subcommands) {
  const auto ended = [](ExitStatus status, const std::string& why) {
    std::istringstream lines(why);  // of a configuration with several errors
    for (std::string line; std::getline(lines, line);) spdlog::error("{}", line);
    return status;
  };
  try {
    const int status = dispatch({argv, static_cast<std::size_t>(argc)}, subcommands);
    return flush_output() ? status : ended(kUnusableStorage, no_output(errno));
  } catch (const StorageError& error) {
    return ended(kUnusableStorage, error.what());
  } catch (const std::system_error& error) {  // fmt::print throws it, too: the stream itself does not keep it
    return ended(kUnusableStorage,
                 std::ferror(stdout) != 0 ? no_output(error.code().value()) : refusal_text(error));
  } catch (const std::bad_alloc&) {
    return ended(kUnusableStorage, current_defect());
  } catch (const ConfigError& error) {
    return ended(kUnusableArguments, error.what());
  } catch (const InputError& error) {
    return ended(kUnusableArguments, error.what());
  } catch (...) {
    return ended(kDefect, current_defect());
  }
}

}  // namespace salbench
