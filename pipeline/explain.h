// salbench explain: why each artefact of an item is a hit or not.
#pragma once

#include <string>
#include <vector>

#include "pipeline/causes.h"
#include "pipeline/commands.h"

namespace salbench {

struct ExplainOptions {
  std::string item;   // "52", "52_3"
  std::string stage;  // empty: all
};

struct Explanation {
  std::string stage;
  std::string state;           // "cached", "to compute", "waiting", "damaged" ...
  std::string why;             // one line; empty of a hit
  std::filesystem::path file;  // the artefact, or the nearest; empty where there is none
};

// In the order of the item's stages. Throws ConfigError where there is no such item or stage.
std::vector<Explanation> explain(const Context& context, const Plan& plan, const std::filesystem::path& cache,
                                 const ExplainOptions& options);

// Throws ConfigError, InputError or StorageError for what makes the whole command impossible.
ExitStatus explain_command(const Arguments& arguments, const ExplainOptions& options);

}  // namespace salbench
