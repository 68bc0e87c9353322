// SPDX-License-Identifier: GPL-3.0-or-later
// The way from the command line to a plan, and to a run of it, shared by all subcommands.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cache/folder_store.h"
#include "pipeline/commands/progress.h"
#include "pipeline/commands/subcommand.h"
#include "pipeline/results/results.h"

namespace salbench {

int thread_count(const Arguments& arguments);

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
  Setup(Config the_config, const Selection& selection);
  // A model more; pictures, where the configuration has less of them.
  explicit Setup(const Arguments& arguments, const std::optional<Model>& given = {},
                 Pictures pictures = Pictures::none);

  Config config;
  Inputs inputs;
  Project project;
  std::filesystem::path cache, output;
};

// The configuration as the command line changes it: folders, models, a model more. Throws ConfigError.
Config read_configuration(const Arguments& arguments, const std::optional<Model>& given = {},
                          Pictures pictures = Pictures::none);
// Folders and split that are given, in place of the configuration's; and the usual folders. Throws
// ConfigError where there is no data set.
void place(Config& config, const Arguments& arguments);
Selection selection_of(const Arguments& arguments);
// Keeps the models of a list such as "LS,PS". Throws ConfigError for a name that the configuration lacks.
void select_models(Config& config, const std::string& list);

// A setup with its cache opened, planned, and ready to run.
struct Session {
  // Throws StorageError.
  Session(Setup the_setup, std::unique_ptr<Progress> the_progress, const std::atomic<bool>& stop);
  // Throws as Setup does, too.
  Session(const Arguments& arguments, const std::atomic<bool>& stop, const std::optional<Model>& given = {},
          Pictures pictures = Pictures::none);

  RunState state() { return {setup.config, setup.inputs, resolver}; }
  double seconds() const;  // since it began
  // Computes what there is to do, or only the rules given and what they read: [rule].
  void run(int threads, const std::string& what = "evaluation", const std::vector<bool>& rules = {});

  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  Setup setup;
  FolderStore store;
  Resolver resolver;
  std::unique_ptr<Progress> progress;
  const std::atomic<bool>& stop;
};

// The end of a subcommand that computes: each says on stderr what the user must know.
std::string interrupted_text(const Arguments& arguments);
ExitStatus interrupted_status(const Arguments& arguments);
ExitStatus finished_status(const Session& session);  // whether all succeeded

}  // namespace salbench
