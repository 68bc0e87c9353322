// The verbs of the program.
#pragma once

#include <atomic>
#include <string>

namespace salbench {

enum ExitStatus {
  kAllDone = 0,
  kSomeFailed = 1,
  kUnusableArguments = 2,  // or configuration
  kUnusableStorage = 3,    // cache or output folder
  kInterrupted = 130,
};

// The command line; empty or 0 where it says nothing.
struct Arguments {
  std::string command_line;  // as typed: the line that resumes
  std::string config;
  std::string data, cache, output;
  std::string items;      // "1-20,52,125"
  std::string reference;  // CSV file with a reference histogram in column GS
  std::string models;     // of `maps`: "LS,PS"; empty: all of the configuration
  std::string to;         // of `maps`: folder that is written to
  bool matched = false;   // of `maps`: after histogram matching
  int threads = 0;        // 0: all cores
  bool quiet = false;     // no progress, no table
};

// Each throws ConfigError, InputError or StorageError for what makes the whole command impossible.
ExitStatus run_command(const Arguments& arguments, const std::atomic<bool>& stop);
ExitStatus maps_command(const Arguments& arguments, const std::atomic<bool>& stop);
ExitStatus plan_command(const Arguments& arguments);
ExitStatus status_command(const Arguments& arguments);

}  // namespace salbench
