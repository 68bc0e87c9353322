// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/density.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/stages/gaze/integral.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// A fixation at these weights of a face, from a distance.
LookedAt on(std::size_t face, const Vec3& weights, double depth = 1, double mass = 1) {
  return {{static_cast<std::uint32_t>(face), weights, depth}, mass};
}

// Largest difference to exp(-d^2 / 2 sigma^2) / whole, relative to its maximum; d(place). At the cut-off of
// three sigma, both values are accepted.
template <class Distance>
double worst(const Mesh& mesh, const ScalarField& density, double sigma, double whole, const Distance& d) {
  double off = 0;
  for (std::size_t v = 0; v < density.size(); ++v) {
    const double scaled = d(mesh.vertices[v]) / sigma;
    const double expected = scaled > 3 ? 0 : std::exp(-scaled * scaled / 2);
    if (std::abs(scaled - 3) > 0.01) off = std::max(off, std::abs(density[v] * whole - expected));
  }
  return off;
}

// Angle in degrees that a length subtends at a distance of 1.
double seen_from_one(double sigma) { return std::atan(sigma) / kRadiansPerDegree; }

TEST(GazeDensity, OnAPlaneIsAGaussian) {
  const Mesh mesh = shapes::grid(100);
  const double sigma = 0.05;  // five edges
  for (const Spread spread : {Spread::geodesic, Spread::euclidean}) {
    const std::size_t face = 10100;
    const Vec3 weights(0.2, 0.3, 0.5), place = on(face, weights).hit.point_in(mesh);
    const auto density = gaze_density(mesh, std::vector{on(face, weights)},
                                      {.degrees = seen_from_one(sigma), .spread = spread});
    EXPECT_NEAR(integral(mesh, density), 1, 1e-9);
    const double whole = 2 * std::numbers::pi * sigma * sigma * (1 - std::exp(-4.5));  // to three sigma
    EXPECT_LT(worst(mesh, density, sigma, whole, [&](const Vec3& p) { return (p - place).norm(); }), 0.01);
  }
}

TEST(GazeDensity, OnASphereIsAGaussianOfGreatCircles) {
  const Mesh mesh = shapes::sphere(5);
  const double sigma = 0.2;  // five edges and more
  const auto density =
      gaze_density(mesh, std::vector{on(3000, {0.2, 0.3, 0.5})}, {.degrees = seen_from_one(sigma)});
  EXPECT_NEAR(integral(mesh, density), 1, 1e-9);
  const Vec3 place = on(3000, {0.2, 0.3, 0.5}).hit.point_in(mesh).normalized();
  double whole = 0;  // integral over the sphere of the undivided density
  for (double angle = 0.00005; angle < 3 * sigma; angle += 0.0001)
    whole += std::exp(-angle * angle / (2 * sigma * sigma)) * 2 * std::numbers::pi * std::sin(angle) * 0.0001;
  EXPECT_LT(worst(mesh, density, sigma, whole,
                  [&](const Vec3& p) { return std::acos(std::clamp(p.dot(place), -1.0, 1.0)); }),
            0.01);
}

TEST(GazeDensity, DoesNotDependOnTheMeshing) {
  const Mesh coarse = shapes::bumpy_sphere(4);
  const Mesh fine = shapes::split_in_four(coarse);
  const GazeDensityOptions options{.degrees = seen_from_one(0.35)};
  const auto before = gaze_density(coarse, std::vector{on(700, {1, 0, 0})}, options);
  const auto after = gaze_density(fine, std::vector{on(4 * 700, {1, 0, 0})}, options);
  EXPECT_NEAR(integral(fine, after), 1, 1e-9);
  const double most = *std::ranges::max_element(before);
  double off = 0;
  for (std::size_t v = 0; v < before.size(); ++v) off = std::max(off, std::abs(after[v] - before[v]));
  EXPECT_LT(off / most, 0.02);
}

// Two sheets, the second `depth` below the first.
Mesh sheets(double depth) {
  Mesh below = shapes::grid(60);
  for (Triangle& face : below.faces) std::swap(face[1], face[2]);
  return shapes::joined(shapes::grid(60), below, {0, 0, -depth});
}

// Share of the density that lies on the first of the sheets.
double on_first(const ScalarField& density) {
  const Mesh first = shapes::grid(60);
  return integral(first, {density.begin(), density.begin() + std::ssize(first.vertices)});
}

TEST(GazeDensity, LeaksThroughAThinPartInSpaceAlone) {
  const double sigma = 0.1;
  for (const auto& [spread, share] : {std::pair(Spread::geodesic, 1.0), {Spread::euclidean, 0.5}})
    EXPECT_NEAR(on_first(gaze_density(sheets(0.1 * sigma), std::vector{on(3600, {1, 0, 0})},
                                      {.degrees = seen_from_one(sigma), .spread = spread})),
                share, spread == Spread::geodesic ? 1e-9 : 0.01);
}

// The tracker's error is isotropic in angle at the eye: on a plane at a grazing angle, the density is that of
// the directions.
TEST(GazeDensity, OfAViewIsAGaussianOfAngles) {
  const Mesh mesh = shapes::grid(200);
  const Vec3 eye(-1, 0.5, 0.5);  // 18 degrees above the plane
  const std::size_t face = 40200;
  LookedAt fixation = on(face, {0.2, 0.3, 0.5});
  fixation.eye = eye;
  fixation.hit.depth = (fixation.hit.point_in(mesh) - eye).norm();
  const auto density = gaze_density(mesh, std::vector{fixation}, {.degrees = 1, .spread = Spread::view});
  EXPECT_NEAR(integral(mesh, density), 1, 1e-9);
  const Vec3 ahead = (fixation.hit.point_in(mesh) - eye).normalized();
  const ScalarField areas = barycentric_areas(mesh.vertices, mesh.faces);
  double second = 0;  // moment of the angle: 2 sigma^2 of a Gaussian of two dimensions, cut at 3 sigma
  for (std::size_t v = 0; v < density.size(); ++v) {
    const Vec3 way = mesh.vertices[v] - eye;
    const double degrees = std::atan2(way.cross(ahead).norm(), way.dot(ahead)) / kRadiansPerDegree;
    EXPECT_TRUE(degrees < 3.01 || density[v] == 0);
    second += density[v] * areas[v] * degrees * degrees;
  }
  const double cut = std::exp(-4.5);
  EXPECT_NEAR(second, 2 - 9 * cut / (1 - cut), 0.02);
}

TEST(GazeDensity, OfAViewIsWhereTheEyeSees) {
  const Mesh mesh = sheets(0.01);
  LookedAt fixation = on(3600, {1, 0, 0}, 1);
  fixation.eye = fixation.hit.point_in(mesh) + Vec3(0, 0, 1);
  EXPECT_NEAR(on_first(gaze_density(mesh, std::vector{fixation}, {.degrees = 5, .spread = Spread::view})), 1,
              1e-9);
  fixation.eye.x() = kNan;
  EXPECT_THAT([&] { gaze_density(mesh, std::vector{fixation}, {.spread = Spread::view}); },
              Refuses("fixation 1: "));
}

TEST(GazeDensity, FixationsHaveTheirShareWhateverTheirWidth) {
  const Mesh mesh = shapes::grid(30);
  // Near and far, one narrower than any face, one beyond the shape, and one that missed.
  std::vector<LookedAt> fixations{on(0, {1, 0, 0}, 0.01, 3), on(900, {0.2, 0.3, 0.5}, 1e-9, 1),
                                  on(1700, {0, 1, 0}, 50, 2)};
  const auto density = gaze_density(mesh, fixations);
  EXPECT_NEAR(integral(mesh, density), 1, 1e-9);
  fixations.push_back({FirstHit{}, 7});
  EXPECT_EQ(gaze_density(mesh, fixations), density);
  const auto alone = gaze_density(mesh, std::vector{fixations[1]});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(alone[index(mesh.faces[900][k])], 0);
  EXPECT_EQ(std::count(alone.begin(), alone.end(), 0.0), static_cast<std::ptrdiff_t>(alone.size() - 3));
  EXPECT_THAT(gaze_density(mesh, {}), Each(0.0));
}

TEST(GazeDensity, FixationsThatAreNoneAreNamed) {
  const auto density = [](const LookedAt& second, const GazeDensityOptions& options = {}) {
    return [=] { gaze_density(shapes::grid(2), std::vector{on(0, {1, 0, 0}), second}, options); };
  };
  for (const LookedAt& bad : {on(8, {1, 0, 0}), on(0, {1, 1, 0}), on(0, {2, -1, 0}), on(0, {1, 0, 0}, 1, -1)})
    EXPECT_THAT(density(bad), Refuses("fixation 2: "));
  const LookedAt without_eye = on(0, {1, 0, 0}, kNan);
  EXPECT_THAT(density(without_eye), Refuses("set `radius`"));
  EXPECT_NO_THROW(density(without_eye, {.radius = 0.1})());
}

}  // namespace
}  // namespace salbench
