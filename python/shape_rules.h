// SPDX-License-Identifier: GPL-3.0-or-later
// The table of rules (pipeline/rules/rules.h) for a single shape in memory, without files or a cache.
#pragma once

#include <vector>

#include "pipeline/rules/rules.h"

namespace salbench::python {

// Given results replace those of their rules; other requested results are computed as in a run.
class ShapeRules {
 public:
  // With the default configuration, and at most one model. `shape`: a Mesh, Scan or PointCloud, matching the
  // level.
  ShapeRules(std::vector<Model> models, Level level, ValuePtr shape);

  Rule& operator[](Role role) { return rules_[number_of(role)]; }  // rule of the same level
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
