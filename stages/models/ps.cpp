// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/ps.h"

#include <Eigen/Eigenvalues>

#include "stages/core/check.h"

namespace salbench {
namespace {

using Axis = Eigen::Matrix<double, kFpfhBins, 1>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, kFpfhBins, Eigen::RowMajor>;

// Bins of the pairs on a flat patch, where theta, alpha and phi are all 0.
constexpr Eigen::Index kFlatBins[] = {5, 16, 27};

Axis first_principal_axis(const Rows& centred) {
  const Eigen::Matrix<double, kFpfhBins, kFpfhBins> covariance =
      centred.transpose() * centred / static_cast<double>(centred.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kFpfhBins, kFpfhBins>> solver(covariance);
  CHECK_EQ(static_cast<int>(solver.info()), static_cast<int>(Eigen::Success));
  return solver.eigenvectors().col(kFpfhBins - 1);  // eigenvalues ascend
}

// The sign of an eigenvector is arbitrary.
void turn_away_from_flat(Axis& axis) {
  double along_flat = 0;
  for (const Eigen::Index bin : kFlatBins) along_flat += axis[bin];
  if (along_flat > 0) axis = -axis;
}

}  // namespace

ScalarField ps_saliency(Points points, const Descriptors& fpfh, const PsOptions& options) {
  CHECK_EQ(fpfh.size(), points.size());
  const auto n = static_cast<Eigen::Index>(fpfh.size());
  if (n == 0) return {};
  using StoredRows = Eigen::Matrix<float, Eigen::Dynamic, kFpfhBins, Eigen::RowMajor>;
  Rows centred = Eigen::Map<const StoredRows>(fpfh.values.data(), n, kFpfhBins).cast<double>();
  const Eigen::Matrix<double, 1, kFpfhBins> mean = centred.colwise().mean();
  centred.rowwise() -= mean;

  Axis axis = first_principal_axis(centred);
  turn_away_from_flat(axis);
  ScalarField saliency(points.size());
  Eigen::Map<Eigen::VectorXd> projection(saliency.data(), n);
  projection = centred * axis;
  if (options.absolute) projection = projection.cwiseAbs();
  return saliency;
}

}  // namespace salbench
