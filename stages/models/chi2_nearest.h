// SPDX-License-Identifier: GPL-3.0-or-later
// The k nearest of a query in a table.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stages/models/chi2_look.h"

namespace salbench {

// One query after the other. Ties at the k-th distance go to the higher index.
class Chi2Nearest {
 public:
  // No distance is above `beyond_all`. 1 <= k <= table.size().
  Chi2Nearest(const Chi2Table& table, const chi2_kernel::Kernel& kernel, std::size_t k, float beyond_all);

  void start(const float* query);

  // `expected`: where the k-th is thought to be; 0: to be guessed from the queries before, which had better
  // resemble this one. A bad guess costs time, no more.
  void find(float expected = 0);
  // The same, unless the k nearest are within rounding: false then, and nothing is found. They are in flat
  // places, where they may be most of the table; after one such query it is enough to look at some of it.
  bool find_unless_alike(float expected);

  // All up to this distance are among the k nearest; others() are the rest.
  float sure() const { return sure_; }
  const std::vector<Chi2Neighbour>& others() const { return others_; }
  float kth() const { return kth_; }  // the k-th distance, or a little more

  // Holds the k nearest, and more.
  const Chi2Look& look() const { return look_; }
  Chi2Look& look() { return look_; }

 private:
  // A distance, and how many of the histograms that were looked at are as near.
  struct Limit {
    float value;
    std::size_t count;
  };

  bool are_alike();
  float guess() const;
  float raised(const Limit& limit) const;
  Limit narrow(Limit& most) const;
  void remember();

  const chi2_kernel::Kernel& kernel_;
  Chi2Look look_;
  std::size_t k_, bins_;
  float beyond_all_, last_above_zero_;
  const float* query_ = nullptr;

  // The last queries, bin by bin as in a group of the table, and their k-th distances.
  std::vector<float> recent_;
  std::array<float, chi2_kernel::kLanes> recent_kth_ = {};
  std::size_t found_ = 0;  // queries so far

  float sure_ = 0, kth_ = 0;
  float short_of_kth_ = 0;  // a distance within which there are fewer than k
  bool alike_ = true;       // those of the last query; of the first it is unknown
  std::vector<Chi2Neighbour> others_;
};

}  // namespace salbench
