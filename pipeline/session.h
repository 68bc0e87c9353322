// The way from the command line to a plan, and to a run of it, shared by all subcommands.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cache/folder_store.h"
#include "pipeline/config.h"
#include "pipeline/plan.h"
#include "pipeline/progress.h"
#include "pipeline/runner.h"
#include "pipeline/workload.h"

namespace salbench {

// The command line; empty or 0 where it says nothing.
struct Arguments {
  std::string command_line;  // as typed: the line that resumes
  std::string config;
  std::string data, cache, output;
  std::string items;      // "1-20,52,125"
  std::string shard;      // of `run` and `plan`: "2/4"
  std::string reference;  // CSV file with a reference histogram in column GS
  std::string models;     // of `maps`: "LS,PS"; empty: all of the configuration
  std::string to;         // of `maps`: folder that is written to
  bool matched = false;   // of `maps`: after histogram matching
  int threads = 0;        // 0: all cores
  bool quiet = false;     // no progress, no table
};

int thread_count(const Arguments& arguments);

// Everything that stands before the first job. The context refers to its neighbours, so it is never moved.
// Throws ConfigError or InputError for what makes the command impossible.
struct Setup {
  explicit Setup(const Arguments& arguments, const std::optional<Model>& given = {});  // a model more
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;

  Config config;
  Catalog catalog;
  Workload workload;
  Context context;
  std::filesystem::path cache, output;
};

// A setup with its cache opened for writing, planned, and ready to run.
struct Session {
  // Throws as Setup does, and StorageError.
  Session(const Arguments& arguments, const std::atomic<bool>& stop, const std::optional<Model>& given = {});

  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  Setup setup;
  FolderStore store;
  Plan plan;
  std::unique_ptr<Progress> progress;
  Runner runner;
};

}  // namespace salbench
