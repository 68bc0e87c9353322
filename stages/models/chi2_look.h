// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms of a table within a distance of a query. Boxes that are farther away stay closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "stages/models/chi2_kernel.h"
#include "stages/models/chi2_table.h"

namespace salbench {

struct Chi2Neighbour {
  std::int32_t index;  // of the histogram
  float chi2;
};

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

}  // namespace salbench
