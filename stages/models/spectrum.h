// SPDX-License-Identifier: GPL-3.0-or-later
// Graph Laplacians of meshes, and the low end of their spectrum.
#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

using SparseMatrix = Eigen::SparseMatrix<double>;

// W (n x n, symmetric): W_ij = 1 / |p_i - p_j|^2 on edges and 0 elsewhere, in 1 / length^2. Edge lengths are
// at least 1e-4 of the mean, so points may coincide. [song2014]
SparseMatrix inverse_square_weights(std::span<const Vec3> points, const Adjacency& adjacency);

// L = D - W, with D the row sums of W.
SparseMatrix graph_laplacian(const SparseMatrix& weights);

// Approximate largest eigenvalue of the Laplacian of a triangle mesh: 1.3 times its largest degree.
double largest_eigenvalue_estimate(const SparseMatrix& laplacian);

struct Eigenpairs {
  Eigen::VectorXd values;   // k, ascending; the first is 0
  Eigen::MatrixXd vectors;  // n x k, orthonormal columns, each of arbitrary sign; the first is constant
};

// The k lowest eigenpairs of the Laplacian of a connected graph, with multiplicity; 1 < k < n - 1. No columns
// if the solver fails. Deterministic to the byte.
Eigenpairs lowest_eigenpairs(const SparseMatrix& laplacian, Eigen::Index k);

// The same for a surface: for its edges, weighted by 1 / distance^2, in units of R. Throws InputError for a
// shape without extent, faces that do not connect all points, k outside of 1 < k < n - 1, and if the solver
// fails. [song2014]
Eigenpairs spectrum_of(Points points, Surface surface, std::size_t k);

}  // namespace salbench
