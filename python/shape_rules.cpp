// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/shape_rules.h"

#include <algorithm>
#include <utility>

namespace salbench::python {
namespace {

// Without a data set, there are rules of meshes and scans.
Inputs inputs_with(Level level) {
  return level == kClouds
             ? Inputs{.units = Units(levels(), {Family{.level = kClouds, .name = {}, .source = {}}})}
             : Inputs();
}

}  // namespace

ShapeRules::ShapeRules(std::vector<Model> models, Level level, ValuePtr shape) : level_(level) {
  Config config;
  config.models = std::move(models);
  config.dataset.meshes = level == kMeshes;
  config.dataset.scans = level == kScans;
  rules_ = make_rules(config, inputs_with(level));
  give(Role::shape, std::move(shape));
}

std::size_t ShapeRules::number_of(Role role) const {
  const auto found = std::ranges::find_if(
      rules_, [&](const Rule& rule) { return has_role(rule, role) && rule.level() == level_; });
  return static_cast<std::size_t>(found - rules_.begin());
}

const ValuePtr& ShapeRules::value(std::size_t number, const RandomSource& random) {
  Rule& rule = rules_[number];
  if (rule.given == nullptr) {
    JobInputs inputs{.random = random};
    for (const std::size_t input : rule.inputs) inputs.values.push_back(value(input, random));
    rule.given = rule.compute(inputs);
  }
  return rule.given;
}

}  // namespace salbench::python
