// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the subcommands that conclude from a table of scores per shape.
#pragma once

#include <memory>
#include <string>

#include "pipeline/commands/subcommand.h"
#include "pipeline/results/conclusions.h"
#include "pipeline/results/score_file.h"

namespace salbench {

struct ScoreOptions {
  std::string scores, classes, unit, higher, lower;
};

Parameters score_parameters(ScoreOptions& options, Parameter scores, const Parameters& further);

struct ConcludedScores {
  ScoreFile file;
  Conclusions conclusions;  // keeps references to the rows of the file
};

// Warns of columns that are left out. Throws ConfigError for a unit that there is none of, and what
// read_scores() throws.
std::unique_ptr<ConcludedScores> conclude_from_file(const ScoreOptions& options);

}  // namespace salbench
