// SPDX-License-Identifier: GPL-3.0-or-later
#include <tuple>

#include "stages/descriptors/fpfh.h"
#include "stages/descriptors/pair_features.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/instructions.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using Row = std::array<double, kFpfhBins>;

constexpr Support kNine{9, 0};

// Reference implementation of the formula: every distance, every pair twice, one bin at a time.
struct Twin {
  const std::vector<Vec3>& points;
  const std::vector<Vec3>& normals;
  Support support;
  FpfhWeighting weighting;
  std::size_t stride = 1;  // stride of the points that may be neighbours of others

  std::vector<std::pair<double, std::size_t>> neighbours_of(std::size_t i) const {
    std::vector<std::pair<double, std::size_t>> all;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j == i || j % stride == 0) all.emplace_back((points[j] - points[i]).norm(), j);
    std::ranges::sort(all);
    if (support.neighbours > 0)
      all.resize(std::min(all.size(), index(support.neighbours)));
    else
      std::erase_if(all, [&](const auto& entry) { return entry.first > support.radius; });
    return all;
  }

  Row spfh(std::size_t i) const {
    Row row{};
    const auto neighbours = neighbours_of(i);
    for (const auto& [distance, j] : neighbours) {
      if (distance == 0) continue;
      Vec3 line = (points[j] - points[i]) / distance, u = normals[i], n = normals[j];
      if (weighting == FpfhWeighting::published &&
          std::acos(std::abs(u.dot(line))) > std::acos(std::abs(n.dot(line)))) {
        std::swap(u, n);
        line *= -1;
      }
      const Vec3 v = u.cross(line).normalized(), w = u.cross(v);
      const double features[] = {std::abs(std::atan2(w.dot(n), u.dot(n))) / std::numbers::pi,
                                 std::abs(v.dot(n)), std::abs(u.dot(line))};
      for (std::size_t f = 0; f < 3; ++f)
        row[11 * f + static_cast<std::size_t>(std::min(std::floor(11 * (features[f] + 1) / 2), 10.0))] +=
            1 / (static_cast<double>(neighbours.size()) - 1);
    }
    return row;
  }

  Row fpfh(std::size_t i) const {
    const bool text = weighting == FpfhWeighting::text;
    const double radius = bounding_radius(points);
    const auto neighbours = neighbours_of(i);
    Row sum = text ? spfh(i) : Row{};
    for (const auto& [distance, j] : neighbours) {
      if (distance == 0) continue;
      const Row row = spfh(j);
      const double weight =
          text ? radius / distance / (static_cast<double>(neighbours.size()) - 1) : 1 / (distance * distance);
      for (std::size_t b = 0; b < row.size(); ++b) sum[b] += weight * row[b];
    }
    if (text) return sum;
    for (std::size_t block = 0; block < 33; block += 11) {
      const double total = std::accumulate(&sum[block], &sum[block] + 11, 0.0);
      for (std::size_t b = block; b < block + 11 && total > 0; ++b) sum[b] *= 100 / total;
    }
    return sum;
  }
};

constexpr std::array kWeightings = {FpfhWeighting::published, FpfhWeighting::text};

// Over a tree of some points, a point outside is still its own neighbour, and has one fewer others.
TEST(FpfhHistogram, EqualsTheFormula) {
  const auto points = shapes::random_cloud(120, 21);
  const auto normals = shapes::random_normals(120, 22);
  for (const std::size_t stride : {1U, 3U}) {
    std::vector<std::int32_t> members;
    for (std::size_t i = 0; i < 120; i += stride) members.push_back(static_cast<std::int32_t>(i));
    for (const Support& support :
         {kNine, Support{30, 0}, Support{1, 0}, Support{500, 0}, Support{0, 0.5}, Support{1, 0.3}})
      for (const auto weighting : kWeightings) {
        const Descriptors fast = fpfh(points, normals, KdTree(points, members), support, weighting);
        const Twin twin{points, normals, support, weighting, stride};
        for (std::size_t i = 0; i < points.size(); ++i) {
          const Row expected = twin.fpfh(i);
          for (std::size_t b = 0; b < expected.size(); ++b)
            ASSERT_NEAR(fast.row(i)[b], expected[b], 1e-5 * std::max(1.0, expected[b]))
                << support.neighbours << " nearest, " << name_of(weighting) << ", point " << i << ", bin "
                << b;
        }
      }
  }
}

TEST(FpfhHistogram, OfASubsetAreTheRowsOfTheWhole) {
  const auto points = shapes::random_cloud(500, 23);
  const auto normals = shapes::random_normals(500, 24);
  const KdTree tree(points);
  const std::vector<std::int32_t> subset = {499, 0, 17, 250};
  for (const Support& support : {kNine, Support{0, 0.15}}) {
    for (const auto weighting : kWeightings) {
      const Descriptors whole = fpfh(points, normals, tree, support, weighting);
      const Descriptors part = fpfh(points, normals, tree, support, weighting, subset);
      ASSERT_EQ(part.size(), subset.size());
      for (std::size_t i = 0; i < subset.size(); ++i)
        EXPECT_TRUE(std::ranges::equal(part.row(i), whole.row(index(subset[i]))));
    }
  }
}

TEST(FpfhHistogram, FlatPatchFallsInOneBinOfEachBlock) {
  const Mesh flat = shapes::grid(6);
  const Normals up(flat.vertices.size(), Vec3::UnitZ());
  const Descriptors d = fpfh(flat.vertices, up, KdTree(flat.vertices), kNine, FpfhWeighting::published);
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t b = 0; b < kFpfhBins; ++b)
      EXPECT_FLOAT_EQ(d.row(i)[b], b == 5 || b == 16 || b == 27 ? 100.0F : 0.0F) << "bin " << b;
}

TEST(FpfhHistogram, CoincidentPointsDoNotVote) {
  // Duplicates are among the 9 nearest, but pairs of them have neither features nor weight.
  auto points = shapes::random_cloud(60, 29);
  auto normals = shapes::random_normals(60, 30);
  for (std::size_t i = 0; i < 60; i += 3) {
    points.push_back(points[i]);
    normals.push_back(normals[i]);
  }
  for (const auto weighting : kWeightings) {
    const Descriptors d = fpfh(points, normals, KdTree(points), kNine, weighting);
    const Twin twin{points, normals, kNine, weighting};
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{60}}) {
      const Row expected = twin.fpfh(i);
      for (std::size_t b = 0; b < kFpfhBins; ++b) EXPECT_NEAR(d.row(i)[b], expected[b], 1e-4);
    }
  }
}

TEST(FpfhHistogram, DegenerateShapesGiveNumbers) {
  const double tiny = 1e-160;  // its square is subnormal
  const std::vector<std::vector<Vec3>> shapes_without_area = {
      {{0, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}},
      std::vector<Vec3>(20, Vec3(1, 2, 3)),
      {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}},  // along the normals: the frame is undefined
      {{0, 0, 0}, {tiny, 0, 0}, {0, 2 * tiny, 0}, {1, 1, 1}}};
  for (const auto& points : shapes_without_area) {
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, 0)}) {
      for (const auto weighting : kWeightings) {
        for (const Support& support : {kNine, Support{0, 0.0}, Support{0, 10.0}}) {
          const Normals normals(points.size(), normal);
          const Descriptors d = fpfh(points, normals, KdTree(points), support, weighting);
          ASSERT_EQ(d.size(), points.size());
          EXPECT_TRUE(std::ranges::all_of(d.values, [](float v) { return std::isfinite(v) && v >= 0; }));
        }
      }
    }
  }
}

TEST(FpfhHistogram, RefusesNormalsThatAreNotFinite) {
  const auto points = shapes::random_cloud(20, 31);
  auto normals = shapes::random_normals(20, 32);
  normals[7].x() = kNan;
  EXPECT_THROW(fpfh(points, normals, KdTree(points), kNine, FpfhWeighting::published), InputError);
}

TEST(PairFeatures, OfARightAngleAreKnown) {
  const DarbouxTriple edge = pair_features({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, false);
  EXPECT_NEAR(edge.phi, 0, 1e-15);
  EXPECT_NEAR(edge.alpha, 0, 1e-15);
  EXPECT_NEAR(std::abs(edge.theta), std::numbers::pi / 2, 1e-15);
  // The other end's normal is parallel to the line, so after the swap the frame has no v.
  const DarbouxTriple swapped = pair_features({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, true);
  EXPECT_EQ(swapped.alpha, 0);
  EXPECT_EQ(swapped.phi, 0);
  EXPECT_EQ(swapped.theta, 0);
}

std::uint8_t bin_by_definition(double value, double limit) {
  const auto bin = static_cast<int>((std::abs(value) / limit + 1) / 2 * 11);
  return static_cast<std::uint8_t>(std::min(bin, 10) - 5);
}

void expect_bins_of_features(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q) {
  for (const bool swap : {false, true}) {
    const DarbouxTriple pair = pair_features(p, n_p, q, n_q, swap);
    const PairBins bins = pair_bins(p, n_p, q, n_q, swap);
    EXPECT_EQ(bins.theta, bin_by_definition(pair.theta, std::numbers::pi));
    EXPECT_EQ(bins.alpha, bin_by_definition(pair.alpha, 1));
    EXPECT_EQ(bins.phi, bin_by_definition(pair.phi, 1));
    if (!bins.both_ways) continue;
    EXPECT_TRUE(swap);
    const PairBins back = pair_bins(q, n_q, p, n_p, swap);
    EXPECT_TRUE(back.both_ways);
    EXPECT_EQ(std::tie(back.theta, back.alpha, back.phi), std::tie(bins.theta, bins.alpha, bins.phi));
  }
}

class PairBinsVariant : public InstructionsTest {};
INSTANTIATE_TEST_SUITE_P(PairBins, PairBinsVariant, every_instruction_set(), name_of_instructions);

TEST_P(PairBinsVariant, AreThoseOfTheFeatures) {
  const auto points = shapes::random_cloud(2000, 36);
  const auto normals = shapes::random_normals(2000, 37);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    expect_bins_of_features(points[i], normals[i], points[i + 1], normals[i + 1]);
    const Vec3 near = (normals[i] + 1e-9 * normals[i + 1]).normalized();
    for (const Vec3& other : {normals[i], Vec3(-normals[i]), near})
      expect_bins_of_features(points[i], normals[i], points[i + 1], other);
    expect_bins_of_features(points[i], normals[i], points[i] + 0.1 * normals[i], normals[i + 1]);
  }
}

TEST_P(PairBinsVariant, OnTheEdgesOfBinsAreThoseOfTheFeatures) {
  const Vec3 origin(0, 0, 0), x(1, 0, 0), z(0, 0, 1);
  for (int bin = 0; bin <= 11; ++bin) {
    const double part = bin / 11.0;
    for (const double off : {0.0, 1e-16, -1e-16, 1e-12, -1e-12, 1e-8, -1e-8}) {
      const double angle = part * std::numbers::pi + off, height = std::clamp(part + off, 0.0, 1.0);
      const Vec3 raised(0, std::sqrt(1 - height * height), height);
      expect_bins_of_features(origin, z, x, {std::sin(angle), 0, std::cos(angle)});  // theta
      expect_bins_of_features(origin, z, raised, x);                                 // phi
      expect_bins_of_features(origin, z, x, {0, height, raised.y()});                // alpha
    }
    // Only phi: a product with kBlockBins may round to another side of its edge than a comparison.
    for (int steps = -8; steps <= 8; ++steps) {
      const double height = std::clamp(part + steps * 0x1p-54, 0.0, 1.0);
      expect_bins_of_features(origin, {height, std::sqrt(1 - height * height), 0}, x, {0.48, 0.6, 0.64});
    }
  }
}

}  // namespace
}  // namespace salbench
