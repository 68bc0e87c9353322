// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the command line to a plan, and to a run of it, shared by all subcommands.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cache/folder_store.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/config/section.h"
#include "pipeline/results/export_file.h"
#include "pipeline/results/results.h"
#include "stages/core/progress.h"

namespace salbench {

// Arguments that several subcommands share; empty if the command line does not give them.
struct Arguments {
  std::string config;
  std::string data, cache, output;
  std::string items;                 // "1-20,52,125", "scored"
  std::optional<std::string> split;  // "test"; "": all items, whatever the configuration takes
  std::string shard;                 // "2/4"
  std::string reference;             // CSV file with a reference histogram in column GS, or kReferenceOfItems
  std::string models;                // "LS,PS"; empty: all of the configuration
  std::string maps, name;            // a folder or file of maps, and what to call their model; empty: none
  bool matched = false;              // their values are histogram-matched already
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  bool quiet = false;           // no progress, no table
  std::string format = "text";  // or "json", and "dot" of a graph
  bool keep_going = false;      // a model that fails alike on its first shapes is tried on all
  bool cached_alone = false;    // computes nothing but shapes and how they look
};

inline constexpr int kMostThreads = 1024;  // that anybody may ask for, here and in the package
inline constexpr std::string_view kReferenceOfItems = "items";  // in place of a file

// The items of a data set that are run, and the histogram that their maps are matched to.
struct Selection {
  ItemChoice items = {};  // all
  std::optional<Shard> shard = {};
  std::optional<Histogram> reference = {};  // nothing: the data set's own mean
  bool reference_of_items = false;          // the mean over the items selected, not over all
};

// Everything that stands before the first job. Throws ConfigError or InputError for what makes the command
// impossible.
struct Setup {
  Setup(Config the_config, Selection the_selection);
  // With pictures, where the configuration has less of them.
  explicit Setup(const Arguments& arguments, Pictures pictures = Pictures::none);

  Selection selection;
  Config config;
  Inputs inputs;
  Project project;
  std::filesystem::path cache, output;
};

struct NoConfigurationError : ConfigError {
  using ConfigError::ConfigError;
};

// The configuration in a file, which may be the record of a run (run.yaml), or if no such file exists that of
// the program of this name: "shrec07", "protocols/3dva". Throws NoConfigurationError if there is neither,
// with the nearest name.
Section configuration(const std::string& given);
// Folders and split that are given, in place of the configuration's; and the usual folders. Throws
// ConfigError where there is no data set.
void place_folders(Config& config, const Arguments& arguments);
// Where the configuration is the record of a run, what its command line chose, unless this one does.
Selection selection_of(const Arguments& arguments);
std::string selection_yaml(const Selection& selection);  // lines of a record; empty for all items
// Keeps the models of a list such as "LS,PS". Throws ConfigError for a name that the configuration lacks.
void select_models(Config& config, const std::string& list);
// The stages that a list names: "map" stands for "map.LS" and all its like, and an empty list for all that
// are known. Throws ConfigError for a word that names none.
StageNames selected_stages(const std::string& list, const std::vector<std::string>& known);

// On standard error: a bar on a terminal, a plain line now and then elsewhere; nothing of what is to be
// quiet.
std::unique_ptr<Progress> progress_of(bool quiet);

// A setup with its cache opened, planned, and ready to run.
struct Session {
  // Throws StorageError.
  Session(Setup the_setup, std::unique_ptr<Progress> the_progress, const std::atomic<bool>& stop,
          bool keep_going);
  // Throws as Setup does, too. Signals stop it.
  explicit Session(const Arguments& arguments, Pictures pictures = Pictures::none);

  RunState state() { return {setup.config, setup.inputs, resolver}; }
  double seconds() const;  // since it began
  // Computes what there is to do, or only the rules given and what they read: [rule].
  void compute(int threads, const std::string& what = "evaluation", const std::vector<bool>& rules = {});

  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  Setup setup;
  FolderStore store;
  Resolver resolver;
  std::unique_ptr<Progress> progress;
  const std::atomic<bool>& stop;
  bool keep_going;
};

ExitStatus finished_status(const Session& session);  // whether all succeeded, and if not says what did not

}  // namespace salbench
