// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/spectrum.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Spectra/SymEigsShiftSolver.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr double kShift = 1e-10;  // below zero, relative to the largest eigenvalue: L itself is singular
constexpr double kLargestPerDegree = 1.3;
constexpr double kMinEdge = 1e-4;     // relative to the mean edge
constexpr double kTolerance = 1e-11;  // relative, for an eigenvalue of the inverse
constexpr double kSameValue = 1e-8;   // relative difference below which eigenvalues are considered equal
constexpr Eigen::Index kMaxRestarts = 1000;

// (L - shift)^-1 on the complement of the known vectors. Spectra's own operator takes twice as long, since it
// does not exploit the symmetry of L.
class DeflatedInverse {
 public:
  using Scalar = double;

  DeflatedInverse(const SparseMatrix& laplacian, double shift) : n_(laplacian.rows()) {
    factors_.setShift(-shift);
    factors_.compute(laplacian);
  }
  bool succeeded() const { return factors_.info() == Eigen::Success; }
  void deflate(const Eigen::MatrixXd& known) { known_ = known; }
  Eigen::VectorXd deflated(const Eigen::VectorXd& x) const { return x - known_ * (known_.transpose() * x); }

  // Interface that Spectra requires of an operator.
  Eigen::Index rows() const { return n_; }
  Eigen::Index cols() const { return n_; }
  void set_shift(double) {}  // fixed at construction: the factors serve several solves
  void perform_op(const double* in, double* out) const {
    const Eigen::VectorXd right = deflated(Eigen::Map<const Eigen::VectorXd>(in, n_));
    Eigen::Map<Eigen::VectorXd>(out, n_) = deflated(factors_.solve(right));
  }

 private:
  Eigen::Index n_;
  Eigen::SimplicialLDLT<SparseMatrix> factors_;
  Eigen::MatrixXd known_;  // n x m, orthonormal columns
};

// A fixed vector with a component along every eigenvector, even for a symmetric mesh.
Eigen::VectorXd start_vector(Eigen::Index n) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  Eigen::VectorXd start(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double spread = static_cast<double>(i + 1) * kGoldenRatio;
    start[i] = spread - std::floor(spread) - 0.5;
  }
  return start;
}

// The `count` lowest pairs that `inverse` is not yet deflated of; no columns if the solver fails.
Eigenpairs further_pairs(DeflatedInverse& inverse, Eigen::Index count, double shift) {
  const Eigen::Index subspace = std::min(inverse.rows(), std::max<Eigen::Index>(3 * count, 20));
  Spectra::SymEigsShiftSolver<DeflatedInverse> solver(inverse, count, subspace, shift);
  const Eigen::VectorXd start = inverse.deflated(start_vector(inverse.rows()));
  try {
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, kTolerance, Spectra::SortRule::SmallestAlge);
  } catch (const std::exception&) {
    return {};  // the start vector is fully deflated, or the tridiagonal problem did not converge
  }
  if (solver.info() != Spectra::CompInfo::Successful) return {};
  return {solver.eigenvalues(), solver.eigenvectors()};
}

// Merges `more` into `pairs`, ascending, and keeps the k lowest.
Eigenpairs merged(const Eigenpairs& pairs, const Eigenpairs& more, Eigen::Index k) {
  Eigen::VectorXd values(pairs.values.size() + more.values.size());
  Eigen::MatrixXd vectors(pairs.vectors.rows(), values.size());
  values << pairs.values, more.values;
  vectors << pairs.vectors, more.vectors;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return values[a] < values[b]; });
  order.resize(static_cast<std::size_t>(std::min(k, values.size())));
  return {values(order), vectors(Eigen::all, order)};
}

}  // namespace

SparseMatrix inverse_square_weights(std::span<const Vec3> points, const Adjacency& adjacency) {
  const auto at = [&](std::int32_t i) -> const Vec3& { return points[static_cast<std::size_t>(i)]; };
  std::vector<Eigen::Triplet<double>> entries;
  double lengths = 0;
  for (std::int32_t i = 0; static_cast<std::size_t>(i) < adjacency.size(); ++i) {
    for (const std::int32_t j : adjacency.of(static_cast<std::size_t>(i))) {
      const double length = (at(i) - at(j)).norm();
      lengths += length;
      entries.emplace_back(i, j, length);
    }
  }
  const double shortest = kMinEdge * lengths / static_cast<double>(std::max<std::size_t>(entries.size(), 1));
  for (auto& entry : entries) {
    const double length = std::max(entry.value(), shortest);
    entry = {entry.row(), entry.col(), 1 / (length * length)};
  }
  const auto n = static_cast<Eigen::Index>(points.size());
  SparseMatrix weights(n, n);
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

SparseMatrix graph_laplacian(const SparseMatrix& weights) {
  const Eigen::VectorXd degrees = weights * Eigen::VectorXd::Ones(weights.cols());
  return SparseMatrix(degrees.asDiagonal()) - weights;
}

double largest_eigenvalue_estimate(const SparseMatrix& laplacian) {
  return kLargestPerDegree * laplacian.diagonal().maxCoeff();
}

Eigenpairs lowest_eigenpairs(const SparseMatrix& laplacian, Eigen::Index k) {
  const Eigen::Index n = laplacian.rows();
  const double shift = -kShift * largest_eigenvalue_estimate(laplacian);
  DeflatedInverse inverse(laplacian, shift);
  if (!inverse.succeeded()) return {};

  // The constant vector is known. Left in, it would dominate the others, since its eigenvalue of the inverse
  // is 1 / shift.
  Eigenpairs pairs{Eigen::VectorXd::Zero(1),
                   Eigen::MatrixXd::Constant(n, 1, 1 / std::sqrt(static_cast<double>(n)))};
  inverse.deflate(pairs.vectors);
  Eigenpairs more = further_pairs(inverse, k - 1, shift);

  // A Krylov space contains only one direction of a repeated eigenvalue, so the search is repeated until it
  // finds no lower pair.
  while (more.values.size() > 0) {
    pairs = merged(pairs, more, k);
    inverse.deflate(pairs.vectors);
    more = further_pairs(inverse, 1, shift);
    if (more.values.size() > 0 && more.values[0] >= (1 - kSameValue) * pairs.values[k - 1]) return pairs;
  }
  return {};
}

Eigenpairs spectrum_of(Points points, Surface surface, std::size_t k) {
  const std::size_t n = points.size();
  check_faces(n, surface);
  const std::vector<Vec3> places = in_units_of_radius(points);
  if (k < 2 || k + 2 > n)
    throw ShapeError("k must be from 2 to n - 2, not " + std::to_string(k) + " of a shape of " +
                     std::to_string(n) + " points");
  const Adjacency adjacency = edge_adjacency(n, surface);
  const std::vector<std::int32_t> parts = connected_components(adjacency);
  if (const auto last = std::ranges::max_element(parts); *last > 0)
    throw ShapeError("the faces connect the points to " + std::to_string(*last + 1) +
                     " parts, where one is expected: there is a spectrum of each");
  Eigenpairs pairs = lowest_eigenpairs(graph_laplacian(inverse_square_weights(places, adjacency)),
                                       static_cast<Eigen::Index>(k));
  if (pairs.values.size() == 0) throw ShapeError("the eigenvalues of the shape cannot be computed");
  return pairs;
}

}  // namespace salbench
