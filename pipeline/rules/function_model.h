// SPDX-License-Identifier: GPL-3.0-or-later
// Maps computed by functions or commands of the user, and models that are Python functions: their part of a
// map's key, and of a run's record. Without the function, maps are still found in the cache.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/config/section.h"
#include "pipeline/inputs/front.h"
#include "pipeline/rules/models.h"

namespace salbench {

// A map computed by user code, and its key besides the parts of the shape that it reads.
struct OwnMap {
  RuleHead head;
  Words reads;  // points, normals, faces, fpfh
  OptionLines options;
  KeyText told = {};    // extra text per shape
  bool seeded = false;  // seed and shape name enter the key
  FunctionCall call = {};
};
Output<ScalarField> add_own_map(RuleTable& table, const ShapeOutputs& shape, const OwnMap& map);

struct FunctionModel {
  std::string name;
  Words reads = {};  // points, normals, faces, fpfh, source
  std::int32_t version = 1;
  std::string key = {};                                  // stands for everything that its maps depend on
  std::map<std::string, std::string> trained_keys = {};  // by shape; empty: not trained
  std::string trained = {};                              // how: "cross-validated, 5 folds by class"
  Words trained_on = {};                                 // items and splits
  std::string description = {};                          // its own description, one line
};

// Throws ConfigError for a name that is taken or invalid.
Model function_model(const FunctionModel& function, FunctionCall call);

// Model from the record of a run: maps missing from the cache fail, since the function is not available.
// Throws ConfigError.
Model recorded_function_model(const std::string& name, const Section& models);

}  // namespace salbench
