// Compares every pair, a few rows of the distance matrix at a time. The k smallest of a row are found in
// three steps: a sample bounds the k-th smallest from above, one sweep keeps what is within the bound, and
// buckets of the few that remain find the k-th itself.
#include "stages/models/chi2_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using chi2_kernel::indices_up_to;
using chi2_kernel::kLanes;
using chi2_kernel::kQueries;

constexpr std::size_t kBins = kFpfhBins;
constexpr std::size_t kSample = 256;
constexpr std::size_t kBuckets = 256;
constexpr float kMinDistance = 1e-30F;  // smaller ones share a bucket
constexpr float kMaxValue = 1e18F;      // the squares of larger values overflow

std::vector<std::size_t> used_bins_of(const Descriptors& descriptors) {
  std::array<bool, kBins> used{};
  for (std::size_t i = 0; i < descriptors.values.size(); ++i) {
    const float value = descriptors.values[i];
    if (!(value >= 0 && value <= kMaxValue))
      throw InputError("the descriptor of point " + std::to_string(i / kBins) + " (0-based) has the value " +
                       std::to_string(value) + ", expected a number from 0 to 1e18");
    if (value > 0) used[i % kBins] = true;
  }
  std::vector<std::size_t> bins;
  for (std::size_t bin = 0; bin < kBins; ++bin)
    if (used[bin]) bins.push_back(bin);
  return bins;
}

std::size_t padded(std::size_t n) { return (n + kLanes - 1) / kLanes * kLanes; }

// Working memory of the selection, reused from row to row.
class Selection {
 public:
  Selection(std::size_t n, std::size_t k) : n_(n), k_(k), indices_(padded(n)), values_(n), selected_(n) {}

  // `row` holds n distances, filled up with infinity to a multiple of 16.
  std::span<const Chi2Neighbour> nearest(const float* row) {
    float bound = sampled_bound(row);
    std::size_t found = indices_up_to(bound, row, indices_.size(), indices_.data());
    if (found < k_) {  // the sampled bound is too low
      bound = *std::max_element(row, row + n_);
      found = indices_up_to(bound, row, indices_.size(), indices_.data());
    }
    return select(row, found, kth_smallest(row, found, bound));
  }

 private:
  // Three standard deviations above the rank that the k-th smallest is expected to have in the sample.
  float sampled_bound(const float* row) {
    const double expected = static_cast<double>(kSample * k_) / static_cast<double>(n_);
    const auto rank = static_cast<std::size_t>(expected + 3 * std::sqrt(expected)) + 1;
    if (n_ < 4 * kSample || rank >= kSample) return *std::max_element(row, row + n_);
    const std::size_t step = n_ / kSample;
    for (std::size_t s = 0; s < kSample; ++s) values_[s] = row[s * step];
    const auto ranked = values_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values_.begin(), ranked, values_.begin() + kSample);
    return *ranked;
  }

  // Sorts the candidates into buckets of their values, so that only the bucket with the k-th has to be
  // ordered.
  float kth_smallest(const float* row, std::size_t found, float bound) {
    const float scale = bound > kMinDistance ? static_cast<float>(kBuckets - 1) / bound : 0;
    const auto bucket_of = [&](std::size_t c) {
      return static_cast<std::uint32_t>(row[indices_[c]] * scale);
    };
    std::array<std::size_t, kBuckets> counts{};
    for (std::size_t c = 0; c < found; ++c) ++counts[bucket_of(c)];
    std::size_t below = 0;
    std::uint32_t bucket = 0;
    while (below + counts[bucket] < k_) below += counts[bucket++];

    std::size_t within = 0;
    for (std::size_t c = 0; c < found; ++c) {
      values_[within] = row[indices_[c]];
      within += bucket_of(c) == bucket;
    }
    const auto kth = values_.begin() + static_cast<std::ptrdiff_t>(k_ - below - 1);
    std::nth_element(values_.begin(), kth, values_.begin() + static_cast<std::ptrdiff_t>(within));
    return *kth;
  }

  // Selects all candidates below the k-th smallest and, of those equal to it, the last ones.
  std::span<const Chi2Neighbour> select(const float* row, std::size_t found, float kth) {
    std::size_t below = 0, equal = 0;
    for (std::size_t c = 0; c < found; ++c) {
      below += row[indices_[c]] < kth;
      equal += row[indices_[c]] == kth;
    }
    std::size_t to_skip = equal - (k_ - below);
    std::size_t selected = 0;
    for (std::size_t c = 0; c < found && selected < k_; ++c) {
      const float distance = row[indices_[c]];
      const bool skip = distance == kth && to_skip > 0;
      to_skip -= skip;
      selected_[selected] = {indices_[c], distance};
      selected += distance <= kth && !skip;
    }
    return {selected_.data(), k_};
  }

  std::size_t n_, k_;
  std::vector<std::int32_t> indices_;  // candidates, ascending
  std::vector<float> values_;
  std::vector<Chi2Neighbour> selected_;
};

}  // namespace

Chi2Search::Chi2Search(const Descriptors& descriptors, chi2_kernel::Instructions instructions)
    : size_(descriptors.size()), groups_(padded(size_) / kLanes), instructions_(instructions) {
  const std::vector<std::size_t> bins = used_bins_of(descriptors);
  bins_ = bins.size();
  table_.resize(groups_ * bins_ * kLanes);
  for (std::size_t i = 0; i < size_; ++i)
    for (std::size_t b = 0; b < bins_; ++b)
      table_[(i / kLanes * bins_ + b) * kLanes + i % kLanes] = descriptors.values[i * kBins + bins[b]];
}

void Chi2Search::for_each(std::size_t k, const Visit& visit) const {
  CHECK_LE(1U, k);
  CHECK_LE(k, size_);
  const std::size_t row = groups_ * kLanes;
  std::vector<float> queries(kQueries * bins_);
  std::vector<float> distances(kQueries * row);
  Selection selection(size_, k);
  for (std::size_t first = 0; first < size_; first += kQueries) {
    // A group holds a multiple of kQueries histograms, so the last queries exist, though they may be padding.
    const float* group = table_.data() + first / kLanes * bins_ * kLanes;
    for (std::size_t q = 0; q < kQueries; ++q)
      for (std::size_t b = 0; b < bins_; ++b) queries[q * bins_ + b] = group[b * kLanes + first % kLanes + q];
    chi2_kernel::distances(instructions_, table_.data(), groups_, bins_, queries.data(), distances.data());
    for (std::size_t q = 0; q < kQueries && first + q < size_; ++q) {
      float* const own = distances.data() + q * row;
      std::fill(own + size_, own + row, std::numeric_limits<float>::infinity());
      visit(first + q, selection.nearest(own));
    }
  }
}

}  // namespace salbench
