// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/descriptors/spfh.h"

#include <limits>

#include "stages/core/parallel.h"

namespace salbench {
namespace {

constexpr std::size_t kMaxForOneThread = 1 << 16;  // points

void add_votes(const PairBins& bins, std::array<std::uint32_t, kSpfhBins>& votes) {
  ++votes[bins.theta];
  ++votes[kFilledBins + bins.alpha];
  ++votes[2 * kFilledBins + bins.phi];
}

// Complement of the ascending indices `these`.
std::vector<std::int32_t> all_except(const std::vector<std::int32_t>& these, std::size_t n) {
  std::vector<std::int32_t> others;
  others.reserve(n - these.size());
  auto next = these.begin();
  for (std::size_t i = 0; i < n; ++i)
    if (next != these.end() && *next == static_cast<std::int32_t>(i))
      ++next;
    else
      others.push_back(static_cast<std::int32_t>(i));
  return others;
}

}  // namespace

SimplifiedHistograms::SimplifiedHistograms(Points points, std::span<const Vec3> normals,
                                           const std::vector<std::int32_t>& requested,
                                           const Neighbourhoods& neighbourhoods, bool swap)
    : points_(points),
      normals_(normals),
      row_of_(points.size(), std::numeric_limits<std::size_t>::max()),
      votes_(requested.size()),
      neighbours_(requested.size()),
      swap_(swap) {
  for (std::size_t row = 0; row < requested.size(); ++row) row_of_[index(requested[row])] = row;
  if (neighbourhoods.mutual() && requested.size() <= kMaxForOneThread)
    vote_by_pairs(requested, neighbourhoods.radius());
  else
    vote_by_points(requested, neighbourhoods);
  rows_.reserve(requested.size() * kSpfhBins);
  for (std::size_t row = 0; row < requested.size(); ++row)
    for (const std::uint32_t count : votes_[row])
      rows_.push_back(static_cast<float>(static_cast<double>(count) / vote_divisor(neighbours_[row])));
  votes_ = {};
}

void SimplifiedHistograms::vote_by_points(const std::vector<std::int32_t>& requested,
                                          const Neighbourhoods& neighbourhoods) {
  parallel_ranges(requested.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    Neighbourhoods::Memory memory;
    for (std::size_t row = first; row < last; ++row) {
      const auto neighbours = neighbourhoods.unordered(requested[row], memory);
      neighbours_[row] = neighbourhoods.others(requested[row], neighbours);
      vote(requested[row], neighbours, false);
    }
  });
}

// Visits each pair of requested points once, for both; single-threaded, since it writes to both.
void SimplifiedHistograms::vote_by_pairs(const std::vector<std::int32_t>& requested, double radius) {
  KdTree(points_, requested).pairs_within(radius, [&](std::int32_t i, std::span<const Neighbour> later) {
    neighbours_[row_of(i)] += later.size();
    for (const Neighbour& neighbour : later) ++neighbours_[row_of(neighbour.index)];
    vote(i, later, true);
  });
  if (requested.size() == points_.size()) return;
  const KdTree others(points_, all_except(requested, points_.size()));
  Neighbourhoods::Memory memory;
  for (const std::int32_t i : requested) {
    others.within_unordered(at(points_, i), radius, memory);
    neighbours_[row_of(i)] += memory.size();
    vote(i, memory, false);
  }
}

// Votes for the point itself, or for both ends of each pair.
void SimplifiedHistograms::vote(std::int32_t i, std::span<const Neighbour> neighbours, bool both) {
  Votes own{};
  std::array<std::int32_t, kPairs> others;
  std::size_t count = 0;
  const auto vote_for_these = [&] {
    vote_for_few(i, std::span(others).first(count), both, own);
    count = 0;
  };
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.coincides()) continue;
    others[count++] = neighbour.index;
    if (count == kPairs) vote_for_these();
  }
  if (count > 0) vote_for_these();
  Votes& sum = votes_[row_of(i)];
  for (std::size_t b = 0; b < kSpfhBins; ++b) sum[b] += own[b];
}

void SimplifiedHistograms::vote_for_few(std::int32_t i, std::span<const std::int32_t> others, bool both,
                                        Votes& own) {
  std::array<PairBins, kPairs> bins;
  pair_bins(at(points_, i), at(normals_, i), points_, normals_, others, swap_, bins);
  for (std::size_t pair = 0; pair < others.size(); ++pair) {
    add_votes(bins[pair], own);
    if (!both) continue;
    const std::int32_t j = others[pair];
    add_votes(bins[pair].both_ways
                  ? bins[pair]
                  : pair_bins(at(points_, j), at(normals_, j), at(points_, i), at(normals_, i), swap_),
              votes_[row_of(j)]);
  }
}

}  // namespace salbench
