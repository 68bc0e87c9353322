// Subcommand `evaluate`: maps of one's own, scored beside the models of a configuration.
#pragma once

#include <atomic>
#include <string>

#include "pipeline/commands.h"

namespace salbench {

struct EvaluateOptions {
  std::string maps;      // folder with ITEM.val, or HDF5 file with a data set ITEM
  std::string name;      // in the tables
  bool matched = false;  // the values are histogram-matched already
};

// A run with one model more. Throws ConfigError, InputError or StorageError.
ExitStatus evaluate_command(const Arguments& arguments, const EvaluateOptions& options,
                            const std::atomic<bool>& stop);

}  // namespace salbench
