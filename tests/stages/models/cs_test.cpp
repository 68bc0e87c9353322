// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cs.h"

#include "stages/core/field.h"
#include "stages/descriptors/fpfh.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/support.h"
#include "stages/models/chi_square.h"
#include "stages/models/cs_clusters.h"
#include "stages/normals/normals.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::Ge;
using testing::Le;

struct Shape {
  std::vector<Vec3> points;
  Normals normals;
};

ScalarField saliency_of(const Shape& shape, const CsOptions& options = {}) {
  return cs_saliency(shape.points, shape.normals, options);
}

Shape shape_of(const Mesh& mesh) { return {mesh.vertices, mesh_normals(mesh)}; }

Shape cloud(std::size_t n, std::uint64_t seed) {
  return {shapes::random_cloud(n, seed), shapes::random_normals(n, seed)};
}

// A flat square with one dent in the middle of its lower left quarter.
Mesh dented_plane(int cells) {
  Mesh mesh = shapes::grid(cells);
  for (Vec3& v : mesh.vertices)
    v.z() = -0.06 * std::exp(-((v - Vec3(0.25, 0.25, 0)).squaredNorm()) / (2 * 0.03 * 0.03));
  return mesh;
}

// Steps 4 to 8 of the benchmark's description, as dense sums over all points and clusters; lengths in units
// of R. `clusters` are those of step 3.
class WrittenOut {
 public:
  WrittenOut(const Shape& shape, const CsOptions& options) : shape_(shape) {
    unit_ = bounding_radius(shape.points);
    const std::vector<std::int32_t> sample = KdTree(shape.points).even_sample(index(options.sample));
    const KdTree tree(shape.points, sample);
    std::vector<Vec3> sampled;
    for (const std::int32_t i : sample) sampled.push_back(shape.points[std::size_t(i)]);
    in_sample_.resize(shape.points.size());
    for (const std::int32_t i : sample) in_sample_[std::size_t(i)] = true;
    const SupportRadius support =
        grown_support_radius(sampled, options.radius * unit_ / bounding_radius(sampled));
    radius_ = support.radius;
    descriptors_ =
        fpfh(shape.points, shape.normals, tree,
             {static_cast<std::int32_t>(std::floor(1.2 * support.neighbours)), 0}, FpfhWeighting::published);
    of_ = cs_clusters(shape.points, descriptors_, radius_, unit_, options);
    clusters_ = group_means(shape.points, descriptors_, of_.of_point, of_.count);
    count_ = static_cast<Eigen::Index>(of_.count);
    n_ = static_cast<Eigen::Index>(shape.points.size());
  }

  // `distribution_weight`: weight of the distribution D in the saliency of a cluster.
  ScalarField saliency(double distribution_weight) {
    const Eigen::MatrixXd chi2 = of_pairs([&](auto j, auto k) { return chi_square(row(j), row(k)); });
    const Eigen::MatrixXd d2 =
        of_pairs([&](auto j, auto k) { return ((centre(j) - centre(k)) / unit_).squaredNorm(); });
    Vec3 mean = Vec3::Zero();
    for (const Vec3& x : clusters_.centres) mean += x / double(count_);
    double vs = 0;
    for (const Vec3& x : clusters_.centres) vs += ((x - mean) / unit_).squaredNorm() / double(count_);
    const double vd = descriptor_variance();

    const Eigen::MatrixXd near = three_rings();
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n_, count_);
    for (Eigen::Index i = 0; i < n_; ++i) {
      for (Eigen::Index k = 0; k < count_; ++k) {
        if (near(cluster_of(i), k) == 0) continue;
        const double d = (point(i) - centre(k)).norm() / unit_;
        w(i, k) =
            std::exp(-d * d / (2 * vs) - 2.5 * chi_square(descriptors_.row(std::size_t(i)), row(k)) / vd);
      }
    }
    const Eigen::RowVectorXd m = w.colwise().sum();
    const Eigen::VectorXd c = m.transpose() / m.sum();
    Eigen::MatrixXd p = w.array().rowwise() / m.array();
    p.array().colwise() /= p.rowwise().sum().array().eval();

    Eigen::VectorXd u(count_), d(count_);
    for (Eigen::Index j = 0; j < count_; ++j) {
      const Eigen::ArrayXd proximity = 1 / (1 + d2.row(j).array().transpose());
      u[j] = (c.array() * chi2.row(j).transpose().array() * proximity).sum() / proximity.sum();
      const Eigen::ArrayXd e = (-chi2.row(j).transpose().array() / vd).exp();
      Vec3 mu = Vec3::Zero();
      for (Eigen::Index k = 0; k < count_; ++k) mu += e[k] / e.sum() * centre(k);
      d[j] = 0;
      for (Eigen::Index k = 0; k < count_; ++k)
        d[j] += c[k] * e[k] / e.sum() * ((centre(k) - mu) / unit_).squaredNorm();
    }
    const Eigen::ArrayXd s =
        distribution_weight * (-scaled(d)).exp() + (1 - distribution_weight) * (1 - (-scaled(u)).exp());
    const Eigen::VectorXd result = p * scaled(s.matrix()).matrix();
    return {result.begin(), result.end()};
  }

  bool some_cluster_out_of_reach() { return (three_rings().array() == 0).any(); }

 private:
  static Eigen::ArrayXd scaled(const Eigen::VectorXd& x) {
    return (x.array() - x.minCoeff()) / (x.maxCoeff() - x.minCoeff());
  }
  const Vec3& point(Eigen::Index i) const { return shape_.points[std::size_t(i)]; }
  Eigen::Index cluster_of(Eigen::Index i) const { return of_.of_point[std::size_t(i)]; }
  std::span<const float, kFpfhBins> row(Eigen::Index k) const {
    return clusters_.descriptors.row(std::size_t(k));
  }

  double descriptor_variance() const {
    std::array<float, kFpfhBins> mean{};
    for (std::size_t b = 0; b < mean.size(); ++b) {
      double sum = 0;
      for (Eigen::Index k = 0; k < count_; ++k) sum += double(row(k)[b]);
      mean[b] = float(sum / double(count_));
    }
    double variance = 0;
    for (Eigen::Index k = 0; k < count_; ++k) variance += chi_square(row(k), mean) / double(count_);
    return variance;
  }

  template <class Value>
  Eigen::MatrixXd of_pairs(const Value& value) const {
    return Eigen::MatrixXd::NullaryExpr(count_, count_, value);
  }

  const Vec3& centre(Eigen::Index k) const { return clusters_.centres[std::size_t(k)]; }
  bool are_neighbours(Eigen::Index i, Eigen::Index q) const { return q != i && in_sample_[std::size_t(q)]; }

  // Positive where cluster k is within three steps of cluster j: the third power of the adjacency.
  Eigen::MatrixXd three_rings() const {
    Eigen::MatrixXd adjacent = Eigen::MatrixXd::Identity(count_, count_);
    for (Eigen::Index i = 0; i < n_; ++i) {
      bool alone = true;
      for (Eigen::Index q = 0; q < n_; ++q) {
        if (!are_neighbours(i, q) || (point(i) - point(q)).squaredNorm() > radius_ * radius_) continue;
        adjacent(cluster_of(i), cluster_of(q)) = 1;
        alone = false;
      }
      if (!alone) continue;
      std::vector<Eigen::Index> order;
      for (Eigen::Index q = 0; q < n_; ++q)
        if (are_neighbours(i, q)) order.push_back(q);
      std::ranges::sort(order, {}, [&](Eigen::Index q) { return (point(i) - point(q)).squaredNorm(); });
      for (std::size_t q = 0; q < 8; ++q) adjacent(cluster_of(i), cluster_of(order[q])) = 1;  // with itself
    }
    return adjacent * adjacent * adjacent;
  }

  const Shape& shape_;
  double unit_ = 0, radius_ = 0;
  std::vector<bool> in_sample_;
  Descriptors descriptors_;
  Clusters of_;
  GroupMeans clusters_;
  Eigen::Index count_ = 0, n_ = 0;
};

void expect_written_out(const Shape& shape, const CsOptions& options) {
  const ScalarField saliency = saliency_of(shape, options);
  WrittenOut twin(shape, options);
  EXPECT_TRUE(twin.some_cluster_out_of_reach());
  EXPECT_THAT(saliency, Pointwise(DoubleNear(1e-9), twin.saliency(options.distribution_weight)));
}

TEST(CsSaliency, EqualsTheFormulasWrittenOut) {
  const Shape bumpy = shape_of(shapes::bumpy_sphere(4));
  expect_written_out(bumpy, {.clusters = 150});
  expect_written_out(shape_of(dented_plane(40)), {.clusters = 150});
  for (const double weight : {0.0, 0.2, 1.0})
    expect_written_out(shape_of(shapes::bumpy_sphere(3)), {.clusters = 60, .distribution_weight = weight});

  Mesh half = shapes::bumpy_sphere(3);
  for (Vec3& v : half.vertices) v *= 0.7;
  const Mesh apart = shapes::joined(shapes::bumpy_sphere(3), half, {5, 1, 0});
  expect_written_out(shape_of(apart), {.clusters = 60});  // the graph of clusters is disconnected

  Shape alone = cloud(500, 3);  // random normals: all descriptors are similar
  alone.points.push_back(Vec3(1.7, 0.5, 0.5));
  alone.normals.push_back(Vec3::UnitX());
  expect_written_out(alone, {.clusters = 60});

  // Neighbours of a point are searched in the sample only; it is always a neighbour of itself. In the second,
  // some points have no other within the radius, others one.
  expect_written_out(bumpy, {.clusters = 150, .sample = 1000});
  expect_written_out(cloud(2500, 7), {.sample = 1000});
}

TEST(CsSample, AsLargeAsTheShapeIsTheShape) {
  const Shape shape = shape_of(shapes::bumpy_sphere(4));  // 2562 points
  const ScalarField whole = saliency_of(shape);
  EXPECT_EQ(saliency_of(shape, {.sample = 2562}), whole);
  EXPECT_EQ(saliency_of(shape, {.sample = 2563}), whole);
  EXPECT_NE(saliency_of(shape, {.sample = 2561}), whole);
}

TEST(CsDegenerate, FewerPointsThanNeighbours) {
  for (std::size_t n = 2; n <= 7; ++n)
    for (const std::int32_t clusters : {1, 2, 500})
      EXPECT_THAT(saliency_of(cloud(n, n), {.clusters = clusters}),
                  AllOf(SizeIs(n), Each(AllOf(Ge(0), Le(1)))))
          << n << " points, " << clusters << " clusters";
}

TEST(CsDegenerate, OneClusterAndConstantDescriptors) {
  for (const ScalarField& saliency : {saliency_of(cloud(50, 3), {.radius = 3, .clusters = 1}),  // one voxel
                                      saliency_of(shape_of(shapes::grid(30)), {.clusters = 50})})
    EXPECT_THAT(saliency, Each(AllOf(Ge(0), Le(1), saliency[0])));
}

TEST(CsDegenerate, PointsTwice) {
  Shape shape = shape_of(shapes::bumpy_sphere(3));
  shape.points.insert(shape.points.end(), shape.points.begin(), shape.points.end());
  shape.normals.insert(shape.normals.end(), shape.normals.begin(), shape.normals.end());
  const ScalarField saliency = saliency_of(shape, {.clusters = 60});
  EXPECT_FALSE(is_constant(saliency));
  const auto middle = saliency.begin() + static_cast<std::ptrdiff_t>(saliency.size() / 2);
  EXPECT_THAT(saliency, Each(AllOf(Ge(0), Le(1))));
  EXPECT_TRUE(std::equal(saliency.begin(), middle, middle,
                         [](double a, double b) { return std::abs(a - b) < 1e-9; }));
}

TEST(CsDegenerate, NearlyConstantDescriptors) {
  // One odd point in a plane: with so small a variance, weights of its descriptor underflow.
  Mesh mesh = shapes::grid(60);
  mesh.vertices[1900].z() += 0.01;
  const ScalarField saliency = saliency_of(shape_of(mesh), {.clusters = 300});
  EXPECT_THAT(saliency, Each(AllOf(Ge(0), Le(1))));
  EXPECT_GT(saliency[1900], 0.5);
}

TEST(CsDegenerate, PointsUnlikeTheirClusters) {
  // Two squares, one cluster each, of pairs of points so close that each point is described by its partner;
  // one half of the normals is vertical, the other horizontal. The clusters' mean descriptors almost agree:
  // with so small a variance no point resembles a cluster, and its weights would all underflow.
  Shape shape;
  for (const double x : {0.0, 64.0}) {
    for (const Vec3& p : shapes::random_cloud(100, 3)) {
      const Vec3 at(x + p.x(), p.y(), 0), normal = p.z() < 0.5 ? Vec3::UnitZ() : Vec3::UnitX();
      shape.points.insert(shape.points.end(), {at, at + Vec3(1e-6, 0, 0)});
      shape.normals.insert(shape.normals.end(), {normal, normal});
    }
  }
  shape.normals.back() = Vec3(1, 0.1, 0).normalized();
  const ScalarField saliency = saliency_of(
      shape, {.radius = 0.05, .clusters = 2, .distribution_weight = 0});  // 1.6: each square is in one cell
  EXPECT_FALSE(is_constant(saliency));
  EXPECT_THAT(saliency, Each(AnyOf(0, 1)));  // value of their own cluster
}

// The search for its support radius used not to end.
TEST(CsSaliency, ASampleInOnePlaceHasAConstantMap) {
  Shape shape{std::vector<Vec3>(3001, Vec3(0.1, 0.2, 0.3)), Normals(3001, Vec3(0, 0, 1))};
  shape.points[7] = {5, 5, 5};
  EXPECT_THAT(saliency_of(shape, {.sample = 1000}), Each(0))
      << "none of the sample is the one that is elsewhere";
}

}  // namespace
}  // namespace salbench
