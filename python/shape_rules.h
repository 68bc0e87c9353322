// SPDX-License-Identifier: GPL-3.0-or-later
// The table of rules (pipeline/rules/rules.h) for one shape in memory, without files and without a cache.
#pragma once

#include <vector>

#include "pipeline/rules/rules.h"

namespace salbench::python {

// What is given takes the place of a rule's result; what else is asked for is computed as a run does it.
class ShapeRules {
 public:
  // With the options that a configuration has by itself, and one model or none. `shape`: a Mesh, Scan or
  // PointCloud, as the level has it.
  ShapeRules(std::vector<Model> models, Level level, ValuePtr shape);

  Rule& operator[](Role role) { return rules_[number_of(role)]; }  // of the level
  void give(Role role, ValuePtr value) { (*this)[role].given = std::move(value); }
  ValuePtr value(Role role, const RandomSource& random = {}) { return value(number_of(role), random); }
  Role role(std::size_t rule) const { return static_cast<Role>(rules_[rule].role); }

 private:
  std::size_t number_of(Role role) const;
  const ValuePtr& value(std::size_t rule, const RandomSource& random);

  Level level_;
  Rules rules_;
};

}  // namespace salbench::python
