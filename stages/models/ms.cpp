// SPDX-License-Identifier: GPL-3.0-or-later
// Song, Liu, Martin and Rosin 2014 as the benchmark's authors ran it. Fitting their published maps and scores
// gave: the window has a width of 9, the zero eigenvalue stays in the spectrum (as the round-off of a dense
// solver left it), and the sums over neighbours are divided by areas. With the zero eigenvalue in the
// spectrum, the irregularity of all frequencies beyond the reach of its window is negligible, so a few
// eigenpairs replace the complete decomposition.
#include "stages/models/ms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"
#include "stages/models/interpolated.h"
#include "stages/models/simplified.h"
#include "stages/models/spectrum.h"

namespace salbench {
namespace {

constexpr double kZeroEigenvalue = 1e-17;  // relative to the largest
constexpr int kScales = 5;
constexpr double kSmoothingReach = 2.5;    // standard deviations
constexpr double kMinAreaFraction = 1e-6;  // least area of a vertex, relative to the mean

// --- the part of the shape that the model uses

// Points relative to the centroid in units of R, because the solvers' thresholds are absolute.
std::vector<Vec3> normalised(std::span<const Vec3> points, double radius) {
  const Vec3 centre = centroid(points);
  std::vector<Vec3> result(points.begin(), points.end());
  for (Vec3& p : result) p = (p - centre) / radius;
  return result;
}

struct Part {
  Mesh mesh;
  std::vector<std::size_t> points;  // points of the shape, one per vertex, ascending
};

Part largest_component(std::span<const Vec3> points, std::span<const Triangle> all_faces) {
  std::vector<Triangle> faces;  // without degenerate ones, which connect nothing
  for (const Triangle& face : all_faces)
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) faces.push_back(face);
  const std::vector<std::int32_t> label = connected_components(edge_adjacency(points.size(), faces));
  std::vector<std::size_t> sizes(points.size(), 0);
  for (const std::int32_t l : label) ++sizes[index(l)];
  const auto largest = std::ranges::max_element(sizes) - sizes.begin();

  Part part;
  std::vector<std::int32_t> vertex(points.size(), -1);  // -1: in another component
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] != largest) continue;
    vertex[i] = static_cast<std::int32_t>(part.points.size());
    part.points.push_back(i);
    part.mesh.vertices.push_back(points[i]);
  }
  for (const auto& [a, b, c] : faces)
    if (vertex[index(a)] >= 0)
      part.mesh.faces.push_back({vertex[index(a)], vertex[index(b)], vertex[index(c)]});
  return part;
}

// Points outside the part take the value of its nearest vertex.
ScalarField on_all_points(std::span<const Vec3> points, const Part& part, const ScalarField& values) {
  const KdTree tree(part.mesh.vertices);
  ScalarField all(points.size());
  for (std::size_t i = 0, v = 0; i < points.size(); ++i) {
    const bool in_part = v < part.points.size() && part.points[v] == i;
    all[i] = values[in_part ? v++ : index(tree.nearest(points[i]))];
  }
  return all;
}

// --- fields on a mesh

ScalarField ring_means(const Adjacency& adjacency, const ScalarField& values) {
  ScalarField means(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double sum = values[i];
    for (const std::int32_t j : adjacency.of(i)) sum += values[index(j)];
    means[i] = sum / static_cast<double>(adjacency.of(i).size() + 1);
  }
  return means;
}

// Barycentric, with a lower limit, since they are divisors.
std::vector<double> vertex_areas(const Mesh& mesh) {
  std::vector<double> areas = barycentric_areas(mesh.vertices, mesh.faces);
  const double smallest = kMinAreaFraction * surface_area(mesh) / static_cast<double>(areas.size());
  for (double& area : areas) area = std::max(area, smallest);
  return areas;
}

// --- the spectrum

// w_f = exp |g(f) - A(f)| - 1, with g = ln lambda and A its moving average. Below its low end, the spectrum
// repeats its first value.
Eigen::VectorXd irregularities(const Eigen::VectorXd& eigenvalues, const MsOptions& options) {
  const Eigen::VectorXd log_spectrum = eigenvalues.array().log();
  const Eigen::Index reach = options.window / 2;
  Eigen::VectorXd irregularity(options.frequencies);
  for (Eigen::Index f = 0; f < irregularity.size(); ++f) {
    double sum = 0;
    for (Eigen::Index k = f - reach; k <= f + reach; ++k) sum += log_spectrum[std::max<Eigen::Index>(k, 0)];
    irregularity[f] = std::expm1(std::abs(log_spectrum[f] - sum / options.window));
  }
  return irregularity;
}

// s_i = sum over the neighbours j of (B diag(w) B')_ij, weighted; empty if the eigensolver failed, or if
// there is no area to divide by.
ScalarField spectral_saliency(const Mesh& mesh, const Adjacency& adjacency, const MsOptions& options) {
  if (options.weight == MsWeight::area && surface_area(mesh) == 0) return {};
  const SparseMatrix weights = inverse_square_weights(mesh.vertices, adjacency);
  const SparseMatrix laplacian = graph_laplacian(weights);
  Eigenpairs low = lowest_eigenpairs(laplacian, options.eigenpairs);
  if (low.values.size() == 0) return {};
  low.values = low.values.cwiseMax(kZeroEigenvalue * largest_eigenvalue_estimate(laplacian));

  const Eigen::MatrixXd basis = low.vectors.leftCols(options.frequencies);
  const Eigen::MatrixXd weighted = basis * irregularities(low.values, options).asDiagonal();
  const std::vector<double> areas = vertex_areas(mesh);
  ScalarField saliency(mesh.vertices.size(), 0);
  for (Eigen::Index i = 0; i < weights.outerSize(); ++i) {
    double& sum = saliency[static_cast<std::size_t>(i)];
    for (SparseMatrix::InnerIterator entry(weights, i); entry; ++entry) {
      const double shared = weighted.row(i).dot(basis.row(entry.row()));
      sum += options.weight == MsWeight::inverse_square ? entry.value() * shared : shared;
    }
    if (options.weight == MsWeight::area) sum /= areas[static_cast<std::size_t>(i)];
  }
  return saliency;
}

// Offset from each point to the Gaussian mean of the shape around it.
std::vector<Vec3> smoothing_moves(const std::vector<Vec3>& points, const KdTree& tree, double variance) {
  std::vector<Vec3> moves(points.size());
  std::vector<Neighbour> around;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tree.within(points[i], kSmoothingReach * std::sqrt(variance), around);
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (const Neighbour& n : around) {
      const double weight = std::exp(-n.distance_squared / (2 * variance));
      sum += weight * (points[index(n.index)] - points[i]);
      weights += weight;
    }
    moves[i] = sum / weights;  // the point itself has weight 1
  }
  return moves;
}

// Sum over the scales of |s(t_k+1) - s(t_k)|; empty if one of them is. The Gaussians are narrower than the
// faces of the simplified mesh, so the full mesh is smoothed and the simplified one follows it.
ScalarField multiscale_saliency(const Mesh& full, const Mesh& coarse, const Adjacency& adjacency,
                                const MsOptions& options) {
  const KdTree tree(full.vertices);
  ScalarField total(coarse.vertices.size(), 0), previous;
  for (int k = 1; k <= kScales; ++k) {
    const std::vector<Vec3> moves = interpolated(
        coarse.vertices, tree, smoothing_moves(full.vertices, tree, k * options.epsilon * options.epsilon));
    Mesh smooth = coarse;
    for (std::size_t i = 0; i < moves.size(); ++i) smooth.vertices[i] += moves[i];
    ScalarField current = spectral_saliency(smooth, adjacency, options);
    if (current.empty()) return {};
    for (std::size_t i = 0; i < previous.size(); ++i) total[i] += std::abs(current[i] - previous[i]);
    previous = std::move(current);
  }
  return total;
}

// Natural logarithm; non-positive values count as the smallest positive one. Empty if no value is positive.
ScalarField logarithm(ScalarField values) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const double v : values)
    if (v > 0) smallest = std::min(smallest, v);
  if (std::isinf(smallest)) return {};
  for (double& v : values) v = std::log(std::max(v, smallest));
  return values;
}

// Empty if the model gives no result.
ScalarField component_saliency(const Mesh& mesh, const MsOptions& options) {
  const Mesh coarse = simplified(mesh, static_cast<std::size_t>(options.faces));
  if (coarse.vertices.size() < kMsSmallestComponent) return {};
  const Adjacency adjacency = edge_adjacency(coarse.vertices.size(), coarse.faces);
  const ScalarField saliency = options.scales == MsScales::paper
                                   ? multiscale_saliency(mesh, coarse, adjacency, options)
                                   : spectral_saliency(coarse, adjacency, options);
  if (saliency.empty()) return {};
  const ScalarField fine =
      interpolated(mesh.vertices, KdTree(coarse.vertices), ring_means(adjacency, saliency));
  return logarithm(ring_means(edge_adjacency(mesh.vertices.size(), mesh.faces), fine));
}

}  // namespace

MsOptions MsOptions::text() {
  MsOptions options;
  options.weight = MsWeight::inverse_square;
  options.scales = MsScales::paper;
  return options;
}

void check(const MsOptions& options) {
  check_ranges(options);
  const auto must = [](bool holds, const char* key, const std::string& what, std::int32_t value) {
    if (!holds) throw OptionError(key, "must be " + what + ", not " + std::to_string(value));
  };
  must(options.window % 2 == 1, "window", "odd", options.window);
  const auto needed = std::int64_t{options.frequencies} + options.window / 2;
  const auto most = static_cast<std::int64_t>(kMsSmallestComponent) - 2;
  must(needed <= most, "frequencies", "such that frequencies + window / 2 <= " + std::to_string(most),
       options.frequencies);
  must(options.eigenpairs >= needed, "eigenpairs",
       "between frequencies + window / 2 = " + std::to_string(needed) + " and " + std::to_string(most),
       options.eigenpairs);
}

ScalarField ms_saliency(Points points, Surface surface, const MsOptions& options) {
  check_faces(points.size(), surface);
  require_finite(points);
  if (points.empty()) return {};
  ScalarField no_answer(points.size(), 0);
  const double radius = bounding_radius(points);
  if (radius == 0) return no_answer;
  const std::vector<Vec3> places = normalised(points, radius);
  if (options.scales == MsScales::paper)
    require_few_neighbours(places, KdTree(places), kSmoothingReach * std::sqrt(kScales) * options.epsilon);
  const Part part = largest_component(places, surface);
  const ScalarField saliency = component_saliency(part.mesh, options);
  return saliency.empty() ? no_answer : on_all_points(places, part, saliency);
}

}  // namespace salbench
