// Subcommands that maintain a cache: verify, gc and accept.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "cache/collect.h"
#include "cache/folder_store.h"
#include "cache/verify.h"
#include "pipeline/commands.h"

namespace salbench {

// Adds what a run of this plan reads or may come to read. Where a job's key is not known yet (what it reads
// is still to be computed, or cannot be read) every artefact of its stage and item is needed: one of them may
// turn out to be the result. Returns how many jobs are of that kind.
std::size_t add_needed(const Context& context, const Plan& plan, KeepSet& needed);

// Computes `sample` cached jobs again, seeded by the configuration's seed, and compares. Stores nothing; a
// job whose input cannot be read is a fault too. Ends early once `stop` is set.
struct Recomputation {
  std::size_t jobs = 0;  // compared
  std::vector<Fault> faults;
};
Recomputation recompute_sample(const Context& context, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop);

// Marks results of earlier versions of a stage as valid for its present one: where options, seed and inputs
// are the same, the newest such result is stored under the new key, with `accepted_from_version` among its
// attributes. What depends on the stage stays valid, since the content is the same.
struct Accepted {
  std::size_t accepted = 0;
  std::size_t valid = 0;    // were there already
  std::size_t missing = 0;  // no earlier version has a result for these options and inputs
  std::size_t waiting = 0;  // what they read is not there
};
// Throws ConfigError where there is no such stage, and StorageError.
Accepted accept_stage(const Context& context, const std::string& stage, FolderStore& store,
                      const std::atomic<bool>& stop);

struct VerifyOptions {
  std::vector<std::string> configs;  // may be empty where the command line names a cache
  bool deep = false;
  std::size_t sample = 20;  // jobs computed again, by configuration
};
struct GcOptions {
  std::vector<std::string> configs;
  bool dry_run = false;
};

ExitStatus verify_command(const Arguments& arguments, const VerifyOptions& options,
                          const std::atomic<bool>& stop);
ExitStatus gc_command(const Arguments& arguments, const GcOptions& options);
ExitStatus accept_command(const Arguments& arguments, const std::string& stage,
                          const std::atomic<bool>& stop);

}  // namespace salbench
