// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/range.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

constexpr Range kShare{0, 1}, kCorrelation{-1, 1}, kDivergence{0, std::numeric_limits<double>::infinity()};

// By the part of the name before the first '_'. Heights in standard deviations and gains have no bounds.
constexpr std::array<std::pair<std::string_view, Range>, 15> kRanges = {{{"auc", kShare},
                                                                         {"cc", kCorrelation},
                                                                         {"lcc", kShare},
                                                                         {"spearman", kCorrelation},
                                                                         {"kl", kDivergence},
                                                                         {"sim", kShare},
                                                                         {"mse", kShare},
                                                                         {"mae", kShare},
                                                                         {"sauc", kShare},
                                                                         {"cosine", kCorrelation},
                                                                         {"fne", kShare},
                                                                         {"fpe", kShare},
                                                                         {"wme", kShare},
                                                                         {"precision", kShare},
                                                                         {"recall", kShare}}};

}  // namespace

Range range_of(std::string_view metric) {
  if (std::ranges::find(metric_table(), metric, &Metric::name) == metric_table().end()) return {};
  const std::string_view family = metric.substr(0, metric.find('_'));
  const auto found = std::ranges::find(kRanges, family, &decltype(kRanges)::value_type::first);
  return found == kRanges.end() ? Range{} : found->second;
}

}  // namespace salbench
