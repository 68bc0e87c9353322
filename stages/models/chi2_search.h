// SPDX-License-Identifier: GPL-3.0-or-later
// Exact search for the histograms nearest to each in chi-square distance, sum (a - b)^2 / (a + b), in O(n)
// memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/models/chi2_kernel.h"
#include "stages/models/chi2_table.h"

namespace salbench {

struct Chi2Neighbour {
  std::int32_t index;  // index of the histogram
  float chi2;
};

// Distances from one query to the histograms of a table. Histograms are measured 16 at a time, once their box
// is within a limit. Keeps a reference to the table; reuses working memory between queries.
class Chi2Distances {
 public:
  Chi2Distances(const Chi2Table& table, const chi2_kernel::Kernel& kernel);

  // Begins the next query. `query` has a value per bin of the table and stays valid until the next.
  void start(const float* query);

  // Measures all histograms within the limit, and some beyond; or the first `max_groups` groups of them.
  // Returns the number of measured ones within the limit.
  std::size_t measure_up_to(float limit, std::size_t max_groups = std::numeric_limits<std::size_t>::max());

  // Number of measured histograms within the limit.
  std::size_t count_up_to(float limit) const;

  // Appends the measured histograms above `low` and up to `high`.
  void append_between(float low, float high, std::vector<Chi2Neighbour>& neighbours);

  std::size_t groups_of_table() const { return levels_.front().groups.size(); }
  // Measured groups; values() has 16 distances for each.
  std::span<const std::int32_t> groups() const {
    return {levels_.front().groups.data(), levels_.front().count};
  }
  const float* values() const { return levels_.front().distances.data(); }

 private:
  // Groups whose 16 members have been visited, with the distances of, or bounds on, these members.
  struct Level {
    std::size_t count = 0;
    std::vector<std::int32_t> groups;
    std::vector<float> distances;

    explicit Level(std::size_t all_groups);
  };

  std::size_t open(Level& level, float limit, std::size_t max_groups, Level& below);
  void measure(const std::int32_t* groups, std::size_t count, float* distances) const;

  const Chi2Table& table_;
  const chi2_kernel::Kernel& kernel_;
  chi2_kernel::PackedTable packed_;
  chi2_kernel::PackedQuery query_;
  // Histograms, boxes around groups of them, boxes around groups of boxes ... Without boxes around boxes LS
  // takes 1.24 times as long on a mesh of 27 118 points.
  std::vector<Level> levels_;
  std::vector<std::int32_t> places_;
};

// The k histograms of a table nearest to a query. Ties at the k-th distance go to the higher index.
// The views are valid until the next query.
struct Chi2Nearest {
  float kth;                              // distance of the k-th, or a little more
  float sure;                             // all histograms within this distance are among the k nearest
  std::span<const Chi2Neighbour> others;  // the rest of the k nearest
  std::span<const std::int32_t> groups;   // groups of the table that contain the k nearest, and more
  const float* distances;                 // groups x 16
};

class Chi2Search;

// Finds the k nearest of successive queries. Keeps a reference to the search.
class Chi2Finder {
 public:
  // 1 <= k <= search.size().
  Chi2Finder(const Chi2Search& search, std::size_t k);

  // `query` has one value per used bin. `expected`: guess of the k-th distance; 0: that of the previous
  // query, which should be similar. A bad guess only costs time.
  Chi2Nearest find(const float* query, float expected = 0);
  // The same, but nullopt if the k nearest differ only by rounding. Such queries lie in flat regions, whose
  // histograms may be most of the table: after one of them, the next is first tried on a few groups.
  std::optional<Chi2Nearest> find_unless_alike(const float* query, float expected);

 private:
  // A distance, and the number of measured histograms within it.
  struct Limit {
    float value;
    std::size_t count;
  };

  Chi2Nearest find_started(float expected);
  bool are_alike();
  float raised(const Limit& limit) const;
  Limit narrow(Limit& most) const;

  Chi2Distances distances_;
  std::size_t k_;
  float beyond_all_;
  float last_kth_, last_kth_above_zero_;
  bool last_alike_ = true;  // initially true: tries the cheap test first
  std::vector<Chi2Neighbour> others_;
};

class Chi2Search {
 public:
  // Ignores bins that are 0 in every histogram. Throws InputError if a value is negative, not finite, or so
  // large that its square overflows. Each histogram is compared with those of `references`, ascending
  // indices; if empty, with all.
  explicit Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references = {});

  std::size_t size() const { return table_.size(); }           // histograms with which each is compared
  std::span<const std::size_t> bins() const { return bins_; }  // used bins, ascending
  float beyond_all() const { return beyond_all_; }             // larger than any distance
  const Chi2Table& table() const { return table_; }
  const chi2_kernel::Kernel& kernel() const { return kernel_; }

  // All histograms, ordered by similarity. A row has the used bins.
  std::span<const std::int32_t> queries() const { return queries_; }
  const float* row(std::size_t query) const { return &rows_[query * bins_.size()]; }

 private:
  std::vector<std::size_t> bins_;
  float beyond_all_;
  std::vector<std::int32_t> queries_;
  std::vector<float> rows_;  // histograms x bins, in the order of the queries
  Chi2Table table_;
  const chi2_kernel::Kernel& kernel_;
};

// Sums chi2 * weight(d) over the k nearest references of each histogram, with d the distance between their
// points; 0 where the k nearest differ by no more than 1e-9 of the largest distance. Terms are rounded, by
// some 2^-37 of the largest distance, so that sums are exact, however the nearest were found.
//   points  one per histogram, no two farther apart than 2; read in single precision
//   kth     per histogram, a guess of its k-th distance, 0 if unknown, or empty;
//           on return the k-th distance, or slightly more
std::vector<double> weighted_sums(const Chi2Search& search, std::size_t k, Points points,
                                  chi2_kernel::Weight weight, std::vector<float>& kth);

}  // namespace salbench
