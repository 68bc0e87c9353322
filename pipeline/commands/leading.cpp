// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/leading.h"

#include <cmath>

namespace salbench {
namespace {

// JSON has no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json json_of(const Leader& leader) {
  return {{"metric", leader.metric->name},
          {"verdict", std::string(name_of(leader.verdict))},
          {"models", leader.models},
          {"mean", number(leader.mean)},
          {"ci95", Json::array({number(leader.interval.low), number(leader.interval.high)})},
          {"second", leader.second},
          {"lead", number(leader.lead)},
          {"lead_ci95", Json::array({number(leader.lead_interval.low), number(leader.lead_interval.high)})},
          {"n", leader.n},
          {"n_shapes", leader.n_shapes}};
}

}  // namespace

Json json_of(const std::vector<LevelLeaders>& leaders) {
  return list_of(leaders, [](const LevelLeaders& level) {
    return Json{{"dataset", level.dataset},
                {"split", level.split},
                {"sentence", level.sentence},
                {"metrics", list_of(level.metrics, [](const Leader& leader) { return json_of(leader); })}};
  });
}

}  // namespace salbench
