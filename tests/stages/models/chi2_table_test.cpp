// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_table.h"

#include "stages/core/rng.h"
#include "stages/models/chi2_kernel.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr std::size_t kLanes = chi2_kernel::kLanes;

// Histograms of 2^k kinds, far apart in one bin, with a little noise in another; equally many of each kind.
struct Kinds {
  Descriptors descriptors;
  std::vector<std::size_t> kind;

  Kinds(std::size_t kinds, std::size_t each) {
    Rng rng(3, "kinds", "");
    for (std::size_t i = 0; i < kinds * each; ++i) kind.push_back(i % kinds);
    for (std::size_t i = kind.size(); i > 1; --i) std::swap(kind[i - 1], kind[rng.below(i)]);
    descriptors.values.resize(kind.size() * kFpfhBins);
    for (std::size_t i = 0; i < kind.size(); ++i) {
      descriptors.values[i * kFpfhBins + 7] = static_cast<float>(100 * kind[i]);
      descriptors.values[i * kFpfhBins + 9] = static_cast<float>(rng.uniform());
    }
  }
};

TEST(GroupedByLikeness, AGroupHoldsHistogramsOfOneKind) {
  const std::vector<std::size_t> bins = {7, 9};
  for (const std::size_t each : {kLanes, 4 * kLanes, 640 * kLanes}) {  // the last spans more than one range
    const Kinds kinds(4, each);
    const std::vector<std::int32_t> order = grouped_by_likeness(kinds.descriptors, bins);
    EXPECT_EQ(std::set(order.begin(), order.end()).size(), kinds.kind.size());
    for (std::size_t place = 0; place < order.size(); ++place)
      ASSERT_EQ(kinds.kind[index(order[place])], place / each) << place;
  }
}

TEST(GroupedByLikeness, LooksAtTheBinsNamedAlone) {
  Kinds kinds(4, kLanes), other = kinds;
  Rng rng(4, "others", "");
  for (std::size_t i = 0; i < other.kind.size(); ++i)
    other.descriptors.values[i * kFpfhBins + 20] = static_cast<float>(1e6 * rng.uniform());
  const std::vector<std::size_t> bins = {7, 9};
  EXPECT_EQ(grouped_by_likeness(other.descriptors, bins), grouped_by_likeness(kinds.descriptors, bins));
}

}  // namespace
}  // namespace salbench
