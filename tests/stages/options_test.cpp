// SPDX-License-Identifier: GPL-3.0-or-later
// Default options of every stage are accepted, and a field outside of its range is named.
#include "stages/metrics/options.h"

#include "stages/descriptors/fpfh.h"
#include "stages/geometry/smoothing.h"
#include "stages/ground_truth/simulation.h"
#include "stages/models/cs.h"
#include "stages/models/floors.h"
#include "stages/models/hs.h"
#include "stages/models/lce.h"
#include "stages/models/ls.h"
#include "stages/models/lvj.h"
#include "stages/models/ms.h"
#include "stages/models/vis.h"
#include "stages/normals/normals.h"
#include "stages/picture/picture.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Name of the field that check() rejects in an options struct; empty if there is none.
template <class Options>
std::string wrong_field(const Options& options) {
  try {
    check(options);
  } catch (const OptionError& error) {
    return error.key;
  }
  return "";
}

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

// Each value separately, in otherwise default options.
template <class Options, class Value>
void refuses(Value Options::*field, const char* name, std::initializer_list<Value> wrong,
             std::initializer_list<Value> right = {}) {
  Options options;
  for (const Value value : wrong) {
    options.*field = value;
    EXPECT_EQ(wrong_field(options), name) << value;
  }
  for (const Value value : right) {
    options.*field = value;
    EXPECT_EQ(wrong_field(options), "") << name << " = " << value;
  }
}

template <class... Options>
void expect_right(const Options&... options) {
  for (const std::string& wrong : {wrong_field(options)...}) EXPECT_EQ(wrong, "");
}

TEST(StageOptions, AreRightByDefaultAndByTheText) {
  expect_right(FpfhOptions{}, SmoothingOptions{}, SimulationOptions{}, MetricsOptions{}, MeshNormalsOptions{},
               ScanNormalsOptions{}, ScanOptions{}, SurfaceOptions{}, PictureOptions{});
  expect_right(LsOptions{}, CsOptions{}, MsOptions{}, HsOptions{}, LvjOptions{}, LceOptions{}, VisOptions{},
               NvOptions{}, SdOptions{}, LsOptions::text(), CsOptions::text(), MsOptions::text());
}

TEST(StageOptions, NameTheFieldThatIsWrong) {
  refuses(&FpfhOptions::neighbours, "neighbours", {1}, {2});
  refuses(&FpfhOptions::radius, "radius", {0.0, -1.0, kNan, kInfinity});
  refuses(&SmoothingOptions::sigma, "sigma", {0.0, -1.0, kNan, kInfinity});
  refuses(&SmoothingOptions::cut, "cut", {0.0, -1.0, kNan, kInfinity});
  refuses(&SimulationOptions::participants, "participants", {0});
  refuses(&SimulationOptions::picks, "picks", {0});
  refuses(&SimulationOptions::random_share, "random_share", {1.1});
  refuses(&SimulationOptions::separation, "separation", {-1.0});
  refuses(&SimulationOptions::scale, "scale", {0.0});
  refuses(&MetricsOptions::splits, "splits", {0}, {1});
  refuses(&MetricsOptions::thresholds, "thresholds", {1}, {2});
  refuses(&MeshNormalsOptions::neighbours, "neighbours", {2, -1});
  refuses(&MeshNormalsOptions::support, "support", {0.0});
  refuses(&MeshNormalsOptions::most_neighbours, "most_neighbours", {2});
  refuses(&MeshNormalsOptions::orientation_neighbours, "orientation_neighbours", {1});
  refuses(&ScanNormalsOptions::neighbours, "neighbours", {2});
  refuses(&ScanNormalsOptions::orientation_neighbours, "orientation_neighbours", {0});
  refuses(&ScanNormalsOptions::gap, "gap", {0.5});
  refuses(&ScanNormalsOptions::max_normal_angle_degrees, "steepest_degrees", {91.0});
  refuses(&ScanOptions::distance, "distance", {0.0, kNan, 1.001e4}, {0.01, 1e4});
  refuses(&ScanOptions::step_degrees, "step_degrees", {0.001, 90.0});
  refuses(&ScanOptions::phase, "phase", {0.7});
  refuses(&SurfaceOptions::reach, "reach", {0.0});
  refuses(&SurfaceOptions::longest_edge, "longest_edge", {kNan});
  refuses(&SurfaceOptions::neighbours, "neighbours", {2});
  refuses(&SurfaceOptions::max_normal_angle_degrees, "steepest_degrees", {0.0});
  refuses(&SurfaceOptions::smallest_angle, "smallest_angle", {61.0});
  refuses(&SurfaceOptions::largest_angle, "largest_angle", {59.0});
}

TEST(StageOptions, OfModelsNameTheFieldThatIsWrong) {
  refuses(&LsOptions::selected_share, "selected_share", {1.5});
  refuses(&LsOptions::foci_share, "foci_share", {-0.1});
  refuses(&LsOptions::foci_sigma, "foci_sigma", {0.0});
  refuses(&LsOptions::high_share, "high_share", {kNan});
  refuses(&LsOptions::high_radius, "high_radius", {-1.0});
  refuses(&LsOptions::high_weight, "high_weight", {kNan});
  refuses(&CsOptions::radius, "radius", {0.0, kInfinity});
  refuses(&CsOptions::clusters, "clusters", {0});
  refuses(&CsOptions::rounds, "rounds", {-1});
  refuses(&CsOptions::descriptor_weight, "descriptor_weight", {kNan});
  refuses(&CsOptions::distribution_weight, "distribution_weight", {1.5});
  refuses(&CsOptions::sample, "sample", {999}, {1000});
  refuses(&MsOptions::faces, "faces", {99});
  refuses(&MsOptions::window, "window", {8, 0});
  refuses(&MsOptions::window, "frequencies", {27});  // more than there are
  refuses(&MsOptions::frequencies, "frequencies", {0, kMost});
  EXPECT_EQ(wrong_field(MsOptions{.window = kMost, .frequencies = kMost}), "frequencies");
  refuses(&MsOptions::eigenpairs, "eigenpairs", {9, 19});
  refuses(&MsOptions::epsilon, "epsilon", {0.0});
  refuses(&HsOptions::draws, "draws", {0, -3});
  refuses(&HsOptions::largest_group, "largest_group", {0, -3});
  refuses(&LvjOptions::epsilon, "epsilon", {0.0});
  refuses(&LvjOptions::faces, "faces", {10});
  refuses(&LceOptions::bins, "bins", {1});
  refuses(&LceOptions::radius, "radius", {0.0});
  refuses(&LceOptions::levels, "levels", {0});
  refuses(&LceOptions::faces, "faces", {10});
  refuses(&VisOptions::directions, "directions", {0});
  refuses(&VisOptions::sample, "sample", {10});
  refuses(&NvOptions::radius, "radius", {0.0});
  refuses(&SdOptions::neighbours, "neighbours", {0});
}

TEST(StageOptions, OfPicturesTakeBothEndsOfTheirRanges) {
  using Options = PictureOptions;
  refuses(&Options::size, "size", {15, 2049}, {16, 2048});
  refuses(&Options::occlusion_samples, "occlusion_samples", {-1, 1025}, {0, 1024});
  refuses(&Options::azimuth, "azimuth", {-180.1, 180.1}, {-180.0, 180.0});
  refuses(&Options::elevation, "elevation", {-89.1, 89.1}, {-89.0, 89.0});
  refuses(&Options::scan_turn, "scan_turn", {-180.1, 180.1}, {-180.0, 180.0});
  refuses(&Options::light_azimuth, "light_azimuth", {-180.1, 180.1}, {-180.0, 180.0});
  refuses(&Options::light_elevation, "light_elevation", {-90.1, 90.1}, {-90.0, 90.0});
  refuses(&Options::field_of_view, "field_of_view", {0.9, 120.1}, {1.0, 120.0});
  refuses(&Options::margin, "margin", {-0.01, 0.46}, {0.0, 0.45});
  refuses(&Options::ambient, "ambient", {-0.1, 1.1}, {0.0, 1.0});
  refuses(&Options::occlusion_strength, "occlusion_strength", {-0.1, 1.1}, {0.0, 1.0});
}

}  // namespace
}  // namespace salbench
