// SPDX-License-Identifier: GPL-3.0-or-later
// A run from its request to its plan and artefacts.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cache/folder_store.h"
#include "pipeline/results/results.h"
#include "pipeline/run/request.h"
#include "stages/core/progress.h"

namespace salbench {

// Everything that is decided before the first job. Throws ConfigError or InputError if the run is impossible.
struct Setup {
  explicit Setup(const Request& request, const Front& front = {});

  Selection selection;
  Config config;
  Inputs inputs;
  Project project;
  std::filesystem::path cache, output;
};

// A setup with an open cache and a plan, ready to run.
struct Session {
  // Throws as Setup does, and StorageError.
  Session(const Request& request, const Front& front, std::unique_ptr<Progress> progress,
          const std::atomic<bool>& stop);

  RunState state() { return {setup.config, setup.inputs, resolver}; }
  double seconds() const;  // since the start
  // Runs the open jobs.
  void compute(int threads);

  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  Setup setup;
  FolderStore store;
  Resolver resolver;
  std::unique_ptr<Progress> progress;
  const std::atomic<bool>& stop;
  bool keep_going;
};

}  // namespace salbench
