// SPDX-License-Identifier: GPL-3.0-or-later
// Maps that functions or commands of the user make, and models that are functions of Python. What the key of
// a map has of one is here, and so is what the record of a run says of it: without the function its maps are
// found in the cache.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/inputs/front.h"
#include "pipeline/rules/models.h"

namespace salbench {

// A map of the user's code, and what its key has beside the parts of the shape that it reads.
struct OwnMap {
  RuleHead head;
  Words reads;  // points, normals, faces, fpfh
  OptionLines options;
  KeyText told = {};    // of each shape
  bool seeded = false;  // the seed and the name of the shape count
  FunctionCall call = {};
};
Output<ScalarField> add_own_map(RuleTable& table, const ShapeOutputs& shape, const OwnMap& map);

struct FunctionModel {
  std::string name;
  Words reads = {};  // points, normals, faces, fpfh, source
  std::int32_t version = 1;
  std::string key = {};                                  // text that stands for what its maps depend on
  std::map<std::string, std::string> trained_keys = {};  // by shape; empty: it was not trained
  std::string trained = {};                              // "cross-validated, 5 folds by class"
  Words trained_on = {};                                 // items and splits
  std::string description = {};                          // what it says of itself, in a line
};

// Throws ConfigError for a name that is taken, or is no name.
Model function_model(const FunctionModel& function, FunctionCall call);

// As the record of a run describes it: maps that are not in the cache fail, since nobody has the function.
// Throws ConfigError.
Model recorded_function_model(const std::string& name, const Section& models);

}  // namespace salbench
