// SPDX-License-Identifier: GPL-3.0-or-later
// Exact search for the histograms nearest to each in chi-square distance, sum (a - b)^2 / (a + b), in O(n)
// memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/models/chi2_kernel.h"
#include "stages/models/chi2_table.h"

namespace salbench {

struct Chi2Neighbour {
  std::int32_t index;  // of the histogram
  float chi2;
};

// Histograms of a table within a distance of a query. Boxes that are farther away stay closed.
// One query after the other, with working memory that is reused. The table outlives it.
class Chi2Look {
 public:
  Chi2Look(const Chi2Table& table, const chi2_kernel::Kernel& kernel);

  // Begins the next query. `query` has a value per bin of the table and stays valid until the next.
  void start(const float* query);

  // Measures all histograms within the limit, and some beyond; or those of the first so many groups. Returns
  // how many are within. Limits may grow from look to look.
  std::size_t up_to(float limit, std::size_t most_groups = std::numeric_limits<std::size_t>::max());

  // Below, of the histograms measured so far; a limit of a look holds all there are.
  std::size_t count_up_to(float limit) const;

  // Appends those above `low` and up to `high`.
  void append_between(float low, float high, std::vector<Chi2Neighbour>& found);

  // Sum of chi2_kernel::term_of over those up to the limit. `places`, groups x 3 x 16, are where the table's
  // histograms lie, `from` where the query does.
  double sum_up_to(float limit, chi2_kernel::Weight weight, float grid, const float* places,
                   const float* from) const;

  std::size_t groups() const { return levels_.front().groups.size(); }  // of the table
  std::size_t opened() const { return levels_.front().count; }          // of them, for this query

 private:
  // Groups whose 16 members have been looked at, and the distances of, or bounds on, these members.
  struct Level {
    std::size_t count = 0;
    std::vector<std::int32_t> groups;
    std::vector<float> distances;

    explicit Level(std::size_t all_groups);
  };

  std::size_t open(Level& level, float limit, std::size_t most, Level& below);
  void measure(const std::int32_t* groups, std::size_t count, float* distances) const;

  const Chi2Table& table_;
  const chi2_kernel::Kernel& kernel_;
  const float* query_ = nullptr;
  std::vector<Level> levels_;  // histograms, boxes around groups of them, boxes around groups of boxes ...
  std::vector<std::int32_t> places_;
};

// The k nearest of a query in a table. One query after the other. Ties at the k-th distance go to the higher
// index.
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

class Chi2Search {
 public:
  // Leaves out bins that are 0 in every histogram. Throws InputError if a value is negative, not finite, or
  // so large that its square overflows. Each histogram is compared with those of `references`, ascending
  // indices, or if there are none with all.
  explicit Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references = {});

  std::size_t size() const { return table_.size(); }           // histograms that each is compared with
  std::span<const std::size_t> bins() const { return bins_; }  // used ones, ascending
  float beyond_all() const { return beyond_all_; }             // more than any distance
  const Chi2Table& table() const { return table_; }
  const chi2_kernel::Kernel& kernel() const { return kernel_; }

  // All histograms; those beside each other resemble each other. A row has the used bins.
  std::span<const std::int32_t> queries() const { return queries_; }
  const float* row(std::size_t query) const { return &rows_[query * bins_.size()]; }

  // 1 <= k <= size().
  Chi2Nearest nearest(std::size_t k) const;

 private:
  std::vector<std::size_t> bins_;
  float beyond_all_;
  std::vector<std::int32_t> queries_;
  std::vector<float> rows_;  // histograms x bins, in the order of the queries
  Chi2Table table_;
  const chi2_kernel::Kernel& kernel_;
};

// Sums chi2 * weight(d) over the k nearest references of each histogram, d the distance between their points;
// 0 where the k nearest differ by no more than 1e-9 of the largest distance. Terms are rounded, by some 2^-37
// of the largest distance, so that sums are exact: how the nearest were found does not show in them.
//   points  one per histogram, no two farther apart than 2; read in single precision
//   kth     per histogram, where its k-th nearest is thought to be, 0 if nothing is known, or empty;
//           afterwards where it is, or a little farther
std::vector<double> weighted_sums(const Chi2Search& search, std::size_t k, Points points,
                                  chi2_kernel::Weight weight, std::vector<float>& kth);

}  // namespace salbench
