// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/ls.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/stages/models/random_histograms.h"
#include "tests/support/correlation.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

// A shape with the descriptors that LS receives: 9 nearest points.
struct Shape {
  std::vector<Vec3> points;
  Normals normals;
  Descriptors low;

  Shape(std::vector<Vec3> p, Normals n)
      : points(std::move(p)),
        normals(std::move(n)),
        low(fpfh(points, normals, KdTree(points), {9, 0}, FpfhWeighting::published)) {}

  ScalarField ls(const LsOptions& options = {}) const { return ls_saliency(points, normals, low, options); }
};

Shape cloud(std::size_t n, std::uint64_t seed) {
  return {shapes::random_cloud(n, seed), shapes::random_normals(n, seed)};
}

// Stretched along a skew axis: mirror-symmetric bumps would give equal distances.
Shape bumps() {
  Mesh mesh = shapes::bumpy_sphere(3);
  Normals normals;
  for (Vec3& v : mesh.vertices) {
    v += 0.2 * v.dot(Vec3(0.3, 0.5, 0.7)) * Vec3(0.3, 0.5, 0.7);
    normals.push_back(v.normalized());
  }
  return {mesh.vertices, normals};
}

// A cloud is so sparse that points have no neighbour within 0.1 R: a wider support makes all descriptors, and
// all distances, distinct.
LsOptions for_clouds() { return {.high_radius = 0.6}; }

// Brute-force reference: the formulas one after the other, by full sorts.
struct Twin {
  const Shape& shape;
  const LsOptions& options;
  std::size_t n = shape.points.size();
  double radius = bounding_radius(shape.points);

  std::size_t count(double share) const {
    return static_cast<std::size_t>(std::floor(share * static_cast<double>(n)));
  }
  double distance(std::size_t i, std::size_t j) const {
    return (shape.points[i] - shape.points[j]).norm() / radius;
  }

  ScalarField distinctness(const Descriptors& descriptors, bool high) const {
    ScalarField result;
    const std::size_t k = count(options.selected_share);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<std::pair<double, std::size_t>> all;
      for (std::size_t j = 0; j < n; ++j)
        all.emplace_back(double{chi2_by_formula(descriptors.row(i), descriptors.row(j))} / 300, j);
      std::ranges::sort(all, [](const auto& a, const auto& b) {
        return std::pair(a.first, b.second) < std::pair(b.first, a.second);
      });
      double sum = 0;
      for (std::size_t c = 0; c < k; ++c) {
        const double d = distance(i, all[c].second);
        sum += high ? all[c].first * std::log(1 + d) : all[c].first / (1 + d);
      }
      result.push_back(1 - std::exp(-sum / static_cast<double>(k)));
    }
    return result;
  }

  std::vector<std::int32_t> top(const ScalarField& field, double share) const {
    std::vector<std::int32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
      return std::pair(field[index(a)], a) > std::pair(field[index(b)], b);
    });
    order.resize(count(share));
    return order;
  }

  ScalarField ls() const {
    const ScalarField low = distinctness(shape.low, false);
    Descriptors mixed = shape.low;
    const KdTree tree(shape.points);
    const Descriptors high =
        fpfh(shape.points, shape.normals, tree, {0, options.high_radius * radius}, options.high_weighting);
    for (const std::int32_t i : top(low, options.high_share))
      for (std::size_t bin = 0; bin < kFpfhBins; ++bin)
        mixed.values[index(i) * kFpfhBins + bin] = high.row(index(i))[bin];
    const ScalarField high_distinctness = distinctness(mixed, true);

    ScalarField result(n);
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = kInfinity, association = 0;
      for (const std::int32_t f : top(low, options.foci_share)) {
        const double d = distance(i, index(f));
        if (d >= nearest) continue;
        nearest = d;
        association = low[index(f)] * std::exp(-d * d / (2 * options.foci_sigma * options.foci_sigma));
      }
      result[i] = low[i] + association + options.high_weight * high_distinctness[i];
    }
    return result;
  }
};

// Terms of the sums have single precision, like chi-square; it was 1e-12 while weights were doubles.
auto is_near(const ScalarField& expected) { return Pointwise(DoubleNear(1e-8), expected); }

void expect_formulas(const Shape& shape, const LsOptions& options) {
  EXPECT_THAT(shape.ls(options), is_near(Twin{shape, options}.ls()));
}

TEST(LsSaliency, EqualsTheFormulas) {
  for (const std::size_t n : {40U, 77U, 333U, 1100U}) expect_formulas(cloud(n, n), for_clouds());
  LsOptions text = LsOptions::text();
  text.high_radius = 0.5;
  expect_formulas(cloud(200, 5), text);
  expect_formulas(bumps(), {});
}

// Three points on a line, R = 1; the histogram of the middle one shares no bin with those of the ends, so
// that chi2 is 2 between them, and 0 elsewhere.
Shape line() {
  Shape shape({{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}, Normals(3, Vec3(0, 0, 1)));
  shape.low.values.assign(3 * kFpfhBins, 0);
  shape.low.values[5] = shape.low.values[kFpfhBins + 6] = shape.low.values[2 * kFpfhBins + 5] = 300;
  return shape;
}

LsOptions all_pairs() { return {.selected_share = 1, .foci_sigma = 1, .high_share = 0}; }

TEST(LsSaliency, OfEquallyDistinctPointsTheHigherIndexIsTheFocus) {
  const double end = 1 - std::exp(-1.0 / 3), middle = 1 - std::exp(-2.0 / 3);
  LsOptions options = all_pairs();
  options.foci_share = 0.67;  // the middle and one of the ends
  options.high_weight = 0;
  EXPECT_THAT(line().ls(options), is_near({end + middle * std::exp(-0.5), 2 * middle, 2 * end}));
}

TEST(LsSaliency, ComparesOnlyWithTheMostSimilar) {
  LsOptions options = all_pairs();
  options.selected_share = 0.67;  // for the ends, each other; for the middle, itself and one end
  options.high_weight = 0;
  options.foci_share = 0;
  const double middle = 1 - std::exp(-1.0 / 2);
  EXPECT_THAT(line().ls(options), is_near({middle * std::exp(-0.5), 2 * middle, middle * std::exp(-0.5)}));
}

TEST(LsSaliency, FewerThanTwentyPointsHaveNoOthersToCompareWith) {
  EXPECT_THAT(cloud(19, 1).ls(), Each(0.0));
}

TEST(LsSaliency, AShapeOfOneKindOfPointIsConstant) {
  Shape shape = cloud(100, 2);
  shape.low.values.assign(shape.low.values.size(), 9);
  EXPECT_THAT(shape.ls({.high_share = 0}), Each(0.0));
}

TEST(LsSaliency, SomeCoincidentPointsDoNoHarm) {
  std::vector<Vec3> points = shapes::random_cloud(100, 3);
  for (std::size_t i = 0; i < 30; ++i) points[i] = points[99];
  const Shape shape(points, shapes::random_normals(100, 3));
  EXPECT_THAT(shape.ls(), Each(AllOf(testing::Ge(0.0), testing::Le(2.5))));
}

TEST(LsSaliency, NamesWhatIsWrongWithAShape) {
  Shape unknown = cloud(50, 1), blind = unknown;
  unknown.low.values[3 * kFpfhBins + 4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { unknown.ls(); }, Refuses("descriptor of point 3"));
  blind.normals[5].x() = kNan;
  EXPECT_THAT([&] { blind.ls(); }, Refuses("normal of point 5"));
}

TEST(LsOptions, SelectAShareOfTheirOwnOnScans) {
  EXPECT_EQ(LsOptions{}.of_meshes().selected_share, 0.05);
  EXPECT_EQ(LsOptions{}.of_scans().selected_share, 0.1);
  EXPECT_EQ(LsOptions{}.of_scans().selected_share_of_scans, 0);  // absent from either key
  EXPECT_EQ(LsOptions::text().of_scans().selected_share, 1);
}

// Above the sample size: an estimate with nearly the same order of points, on any number of threads.
TEST(LsSaliency, OfALargeShapeIsEstimatedFromASample) {
  const Mesh mesh = shapes::bumpy_sphere(5);
  Normals normals;
  for (const Vec3& v : mesh.vertices) normals.push_back(v.normalized());
  const std::vector<Vec3> roughness = shapes::random_normals(normals.size(), 2);
  for (std::size_t i = 0; i < normals.size(); ++i)
    normals[i] = (normals[i] + 0.05 * roughness[i]).normalized();
  const Shape shape(mesh.vertices, normals);
  ASSERT_GT(shape.points.size(), 10'000U);
  const ScalarField exact = shape.ls(),
                    estimate = same_on_any_number_of_threads([&] { return shape.ls({.sample = 4000}); });
  EXPECT_NE(exact, estimate);
  EXPECT_GT(spearman(exact, estimate), 0.99);
}

}  // namespace
}  // namespace salbench
