// SPDX-License-Identifier: GPL-3.0-or-later
// The negative log-likelihood is convex in f and c at their knots, and so is its domain: Newton's method with
// the constraints that hold as equalities finds the only minimum.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "stages/core/parallel.h"
#include "stages/fitting/bins.h"

namespace salbench {
namespace {

using fitting::Between;
using fitting::DistanceBins;
using fitting::ValueBins;

// f and c at their knots; and as what is fitted: the steps of f from knot to knot, >= 0, then c.
constexpr Eigen::Index kKnots = kValueKnots + kDistanceKnots, kSteps = kValueKnots - 1, kFree = kKnots - 1;
using AtKnots = Eigen::Matrix<double, kKnots, 1>;
using Fitted = Eigen::Matrix<double, kFree, 1>;

constexpr double kPenalty = 1e-3;    // half the sum of squares, against a mean over shapes
constexpr double kTolerance = 1e-9;  // of the gradient
constexpr int kMostSteps = 100;

Eigen::Matrix<double, kKnots, kFree> knots_of_fitted() {
  Eigen::Matrix<double, kKnots, kFree> sums = Eigen::Matrix<double, kKnots, kFree>::Zero();
  for (Eigen::Index step = 0; step < kSteps; ++step) sums.block(step + 1, step, kSteps - step, 1).setOnes();
  sums.bottomRightCorner(static_cast<Eigen::Index>(kDistanceKnots), static_cast<Eigen::Index>(kDistanceKnots))
      .setIdentity();
  return sums;
}
const Eigen::Matrix<double, kKnots, kFree> kSums = knots_of_fitted();

// A cell between two knots of f and two of c.
struct Weights {
  std::array<Eigen::Index, 4> knot;
  std::array<double, 4> weight;

  explicit Weights(std::int32_t cell) {
    const std::size_t in_blur = index(cell) % (ValueBins::count * DistanceBins::count);
    const Between value = ValueBins::middle(in_blur / DistanceBins::count);
    const Between distance = DistanceBins::middle(in_blur % DistanceBins::count);
    const auto first = static_cast<Eigen::Index>(value.knot),
               second = static_cast<Eigen::Index>(kValueKnots + distance.knot);
    knot = {first, first + 1, second, second + 1};
    weight = {1 - value.of_upper, value.of_upper, 1 - distance.of_upper, distance.of_upper};
  }
};

// The cells of one blur of a shape.
struct Part {
  std::span<const std::int32_t> cells;
  std::span<const float> points, marked;
};
Part part_of(const DensityCounts& shape, std::size_t blur) {
  const auto begin_of = [&](std::size_t b) {
    const auto first = static_cast<std::int32_t>(b * ValueBins::count * DistanceBins::count);
    return static_cast<std::size_t>(std::ranges::lower_bound(shape.cells, first) - shape.cells.begin());
  };
  const std::size_t begin = begin_of(blur), n = begin_of(blur + 1) - begin;
  return {std::span(shape.cells).subspan(begin, n), std::span(shape.points).subspan(begin, n),
          std::span(shape.marked).subspan(begin, n)};
}

// Mean over shapes of -log likelihood against the uniform map, with its derivatives.
struct Loss {
  double value = 0;
  AtKnots gradient = AtKnots::Zero();
  Eigen::Matrix<double, kKnots, kKnots> hessian = Eigen::Matrix<double, kKnots, kKnots>::Zero();
};

void add_shape(Loss& loss, const Part& shape, const AtKnots& knots) {
  double sum = 0, marked = 0;  // 1, but for single precision
  AtKnots mean = AtKnots::Zero();
  Eigen::Matrix<double, kKnots, kKnots> squares = Eigen::Matrix<double, kKnots, kKnots>::Zero();
  for (std::size_t k = 0; k < shape.cells.size(); ++k) {
    const Weights cell(shape.cells[k]);
    double height = 0;
    for (int a = 0; a < 4; ++a) height += cell.weight[a] * knots[cell.knot[a]];
    const double mass = shape.points[k] * std::exp(height);
    sum += mass;
    marked += shape.marked[k];
    loss.value -= shape.marked[k] * height;
    for (int a = 0; a < 4; ++a) {
      mean[cell.knot[a]] += mass * cell.weight[a];
      loss.gradient[cell.knot[a]] -= shape.marked[k] * cell.weight[a];
      for (int b = 0; b < 4; ++b)
        squares(cell.knot[a], cell.knot[b]) += mass * cell.weight[a] * cell.weight[b];
    }
  }
  mean /= sum;
  loss.value += marked * std::log(sum);
  loss.gradient += marked * mean;
  loss.hessian += marked * (squares / sum - mean * mean.transpose());
}

struct Objective {
  std::vector<Part> shapes;

  Loss loss(const Fitted& fitted) const {
    Loss loss;
    const AtKnots knots = kSums * fitted;
    for (const Part& shape : shapes) add_shape(loss, shape, knots);
    const auto n = static_cast<double>(shapes.size());
    loss.value /= n;
    loss.gradient /= n;
    loss.hessian /= n;
    return loss;
  }
};
double penalised(const Loss& loss, const Fitted& fitted) {
  return loss.value + kPenalty / 2 * fitted.squaredNorm();
}

// Steps of f that are 0, and would be below it if they might, stay where they are.
Fitted newton_step(const Fitted& gradient, const Eigen::Matrix<double, kFree, kFree>& hessian,
                   const Fitted& fitted) {
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < kFree; ++i)
    if (i >= kSteps || fitted[i] > 0 || gradient[i] < 0) moving.push_back(i);
  const Eigen::VectorXd step = hessian(moving, moving).eval().ldlt().solve(gradient(moving).eval());
  Fitted whole = Fitted::Zero();
  for (std::size_t k = 0; k < moving.size(); ++k) whole[moving[k]] = step[static_cast<Eigen::Index>(k)];
  return whole;
}

Fitted moved(Fitted fitted, const Fitted& step, double by) {
  fitted -= by * step;
  fitted.head(kSteps) = fitted.head(kSteps).cwiseMax(0);
  return fitted;
}

Fitted minimised(const Objective& objective, Fitted fitted) {
  Loss loss = objective.loss(fitted);
  for (int k = 0; k < kMostSteps; ++k) {
    const Fitted gradient = kSums.transpose() * loss.gradient + kPenalty * fitted;
    if ((moved(fitted, gradient, 1) - fitted).cwiseAbs().maxCoeff() < kTolerance) break;
    Eigen::Matrix<double, kFree, kFree> hessian = kSums.transpose() * loss.hessian * kSums;
    hessian.diagonal().array() += kPenalty;
    const double before = penalised(loss, fitted);
    // Newton's step may lead nowhere where constraints begin to hold; the gradient's does not.
    bool lower = false;
    Fitted next;
    Loss of_next;
    for (const Fitted& step : {newton_step(gradient, hessian, fitted), gradient})
      for (double by = 1; !lower && by > 1e-9; by /= 2) {
        next = moved(fitted, step, by);
        of_next = objective.loss(next);
        lower = penalised(of_next, next) < before;
      }
    if (!lower) break;
    fitted = next;
    loss = of_next;
  }
  return fitted;
}

DensityFit fit_to_others(const std::vector<std::shared_ptr<const DensityCounts>>& shapes, std::int32_t fold) {
  DensityFit best;
  double least = std::numeric_limits<double>::infinity();
  Fitted fitted = Fitted::Zero();
  for (std::size_t blur = 0; blur < kBlurWidths.size(); ++blur) {
    Objective objective;
    for (const auto& shape : shapes)
      if (shape->fold != fold && !shape->cells.empty()) objective.shapes.push_back(part_of(*shape, blur));
    if (objective.shapes.empty()) return {};
    fitted = minimised(objective, fitted);
    const Loss loss = objective.loss(fitted);
    if (!(penalised(loss, fitted) < least)) continue;
    least = penalised(loss, fitted);
    best.shapes = std::ssize(objective.shapes);
    best.blur = kBlurWidths[blur];
    best.gain = -loss.value / std::numbers::ln2;
    const AtKnots knots = kSums * fitted;
    std::copy_n(knots.data(), kValueKnots, best.value.begin());
    std::copy_n(knots.data() + kValueKnots, kDistanceKnots, best.distance.begin());
  }
  return best;
}

}  // namespace

DensityFits fit_densities(const std::vector<std::shared_ptr<const DensityCounts>>& shapes,
                          std::int32_t folds) {
  DensityFits fits(index(folds));
  parallel_ranges(fits.size(), 1, [&](std::size_t fold, std::size_t) {
    fits[fold] = fit_to_others(shapes, static_cast<std::int32_t>(fold));
  });
  return fits;
}

}  // namespace salbench
