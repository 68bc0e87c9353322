#include <csignal>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/commands.h"
#include "pipeline/evaluate.h"
#include "pipeline/explain.h"
#include "pipeline/export.h"
#include "pipeline/interrupt.h"
#include "pipeline/maintenance.h"
#include "stages/core/errors.h"

namespace {

using namespace salbench;

constexpr const char* kExamples = R"(Examples:
  salbench run configs/shrec07.yaml --data SchellingData          the whole benchmark; run it again to resume
  salbench run configs/shrec07.yaml --data SchellingData --items 1-20,52,125
  salbench maps configs/shrec07.yaml --data SchellingData --items 52 --models LS,PS --to maps
  salbench export configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5
  salbench plan configs/shrec07.yaml --data SchellingData         what a run would compute, and why
  salbench explain configs/shrec07.yaml 52_3 --data SchellingData what differs from what the cache has
  salbench status configs/shrec07.yaml --data SchellingData       what is there already

Exit status: 0 all done; 1 some items failed, each was named; 2 unusable arguments or configuration;
3 cache or output folder unusable; 70 a defect of the program, or memory ran out;
130 interrupted, the line that resumes was printed.)";

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& what,
                         Arguments& arguments) {
  CLI::App* subcommand = app.add_subcommand(name, what);
  subcommand->add_option("CONFIG", arguments.config, "configuration file (YAML); see configs/")->required();
  subcommand->add_option("--data", arguments.data, "folder of the data set");
  subcommand->add_option("--cache", arguments.cache,
                         "folder of the artefacts (default: cache in CONFIG, or salbench-cache)");
  subcommand->add_option("--out", arguments.output,
                         "folder of the results (default: output in CONFIG, or salbench-out/NAME)");
  subcommand
      ->add_option("--threads", arguments.threads,
                   "threads (default: all cores); results do not depend on it")
      ->check(CLI::Range(1, 1024));
  subcommand->add_option("--items", arguments.items,
                         "only these meshes and their scans, such as 1-20,52,125");
  subcommand->add_option(
      "--reference", arguments.reference,
      "match to this histogram (CSV with a column GS of 100 bins), not to the data set's own mean");
  subcommand->add_flag("--quiet", arguments.quiet, "neither progress nor tables; warnings and errors only");
  return subcommand;
}

// A subcommand that maintains the cache of the configurations it names.
CLI::App* add_maintenance(CLI::App& app, const std::string& name, const std::string& what,
                          Arguments& arguments) {
  CLI::App* subcommand = app.add_subcommand(name, what);
  subcommand->add_option("--data", arguments.data, "folder of the data set");
  subcommand->add_option("--cache", arguments.cache,
                         "folder of the artefacts (default: cache in CONFIG, or salbench-cache)");
  subcommand->add_option("--items", arguments.items, "as of the run: only these meshes and their scans");
  subcommand->add_option("--reference", arguments.reference, "as of the run: match to this histogram");
  subcommand->add_flag("--quiet", arguments.quiet, "name what is wrong, and nothing else");
  return subcommand;
}

// As a shell reads it back as the same word.
std::string shell_word(const std::string& word) {
  constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string joined(int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += (i > 0 ? " " : "") + shell_word(argv[i]);
  return line;
}

int dispatch(int argc, char** argv) {
  CLI::App app{"Benchmark of 3D saliency models on meshes and simulated range scans."};
  app.set_version_flag("--version", "salbench " SALBENCH_VERSION);
  app.footer(kExamples);
  app.require_subcommand(1);
  Arguments arguments;
  arguments.command_line = joined(argc, argv);
  CLI::App* run = add_subcommand(app, "run", "compute what is missing and write the tables", arguments);
  constexpr const char* kShard = "only share I of N of the items; a run without it then merges the shares";
  run->add_option("--shard", arguments.shard, kShard)->type_name("I/N");
  CLI::App* maps = add_subcommand(
      app, "maps", "compute saliency maps and write TO/MODEL/ITEM.val, one value per line", arguments);
  maps->add_option("--models", arguments.models, "only these, such as LS,PS");
  maps->add_option("--to", arguments.to, "folder that the maps are written to")->required();
  maps->add_flag("--matched", arguments.matched, "after histogram matching");
  EvaluateOptions evaluated;
  CLI::App* evaluate = add_subcommand(
      app, "evaluate", "a run that also scores saliency maps of your own, made by any program", arguments);
  evaluate
      ->add_option(
          "--maps", evaluated.maps,
          "folder with ITEM.val (52.val of a mesh, 52_3.val of its scan 3; one value per line), or an "
          "HDF5 file with a data set ITEM")
      ->required();
  evaluate->add_option("--name", evaluated.name, "what to call them in the tables")->required();
  evaluate->add_option("--models", arguments.models, "beside these models only, such as LS,PS");
  evaluate->add_flag("--matched", evaluated.matched, "the values are histogram-matched already");
  ExportOptions exported;
  CLI::App* exports = add_subcommand(
      app, "export", "write what is known of some items to one HDF5 file, or to shapes for viewers",
      arguments);
  exports->add_option("--stage", exported.stages,
                      "only these stages, such as scan,fpfh,map.LS; map stands for all of map.*");
  exports->add_option("--models", arguments.models, "only these, such as LS,PS");
  exports->add_option("--to", arguments.to, "the HDF5 file, or the folder of the shapes")->required();
  exports->add_option("--format", exported.format, "h5 (default), or one shape per item: csv, ply, vtp");
  exports->add_flag("--link", exported.link, "refer to the artefacts in the cache, do not copy them");
  CLI::App* plan =
      add_subcommand(app, "plan", "count what a run would compute, and why; changes nothing", arguments);
  plan->add_option("--shard", arguments.shard, kShard)->type_name("I/N");
  ExplainOptions explained;
  CLI::App* explain = add_subcommand(
      app, "explain", "tell of each artefact of an item whether it is cached, and if not what differs",
      arguments);
  explain->add_option("ITEM", explained.item, "a mesh (52) or a scan of it (52_3)")->required();
  explain->add_option("STAGE", explained.stage, "this stage only");
  add_subcommand(app, "status", "count what is in the cache; changes nothing", arguments);
  VerifyOptions verified;
  CLI::App* verify = add_maintenance(
      app, "verify", "read every artefact of a cache and name each bad one; changes nothing", arguments);
  verify->add_option("CONFIG", verified.configs, "configuration files, or none with --cache");
  verify->add_flag("--deep", verified.deep, "also compute a sample of the cached jobs again, and compare");
  verify->add_option("--sample", verified.sample, "how many (default: 20)")->check(CLI::PositiveNumber);
  GcOptions collected;
  CLI::App* gc =
      add_maintenance(app, "gc", "remove from a cache what no run of these configurations needs", arguments);
  gc->add_option("CONFIG", collected.configs, "every configuration whose artefacts are kept")->required();
  gc->add_flag("--dry-run", collected.dry_run, "only say what would be removed");
  std::string accepted_stage;
  CLI::App* accept = add_maintenance(
      app, "accept", "take results of a stage's earlier versions for those of its present one", arguments);
  accept->add_option("CONFIG", arguments.config, "configuration file")->required();
  accept->add_option("STAGE", accepted_stage, "such as fpfh or map.LS")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kAllDone : kUnusableArguments;
  }
  handle_interrupts(interrupted_text(arguments));
  const std::atomic<bool>& stop = interrupted();
  if (run->parsed()) return run_command(arguments, stop);
  if (maps->parsed()) return maps_command(arguments, stop);
  if (evaluate->parsed()) return evaluate_command(arguments, evaluated, stop);
  if (exports->parsed()) return export_command(arguments, exported, stop);
  if (verify->parsed()) return verify_command(arguments, verified, stop);
  if (gc->parsed()) return gc_command(arguments, collected);
  if (accept->parsed()) return accept_command(arguments, accepted_stage, stop);
  if (explain->parsed()) return explain_command(arguments, explained);
  return plan->parsed() ? plan_command(arguments) : status_command(arguments);
}

int guarded(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
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

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("salbench"));
  spdlog::set_pattern("%^%l%$: %v");
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes then fails the write, as a full disk does
  return guarded(argc, argv);
}
