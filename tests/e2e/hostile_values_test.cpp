// SPDX-License-Identifier: GPL-3.0-or-later
// Finite numbers whose ranges, sums or squares are not: whatever one item holds, the run ends, and the others
// have the scores that they have without it.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/shapes/values_file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

constexpr const char* kAllMetrics = "metrics: all\nscan: {step_degrees: 1}\nmodels: {PS: , RS: , HS: }\n";

std::string lines_of(const ScalarField& values) {
  std::string lines;
  for (const double value : values) lines += fmt::format("{}\n", value);
  return lines;
}

ScalarField values_in(const fs::path& file) { return parse_values(read_file(file), file.string()); }

// From -1.99 to 1.99 of that power of two: a range beyond doubles for 1023.
ScalarField spread(ScalarField values, int power) {
  const auto [least, most] = std::ranges::minmax(values);
  for (double& value : values) value = std::ldexp(3.98 * (value - least) / (most - least) - 1.99, power);
  return values;
}

struct Tables {
  std::string results, histograms;
  bool operator==(const Tables&) const = default;
};
void PrintTo(const Tables& tables, std::ostream* out) { *out << tables.results << tables.histograms; }

Tables tables_of(const Workspace& toy) {
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 0) << run.err;
  const Tables tables{toy.results(), read_file(toy.out() / "mean_histograms_meshes.csv")};
  EXPECT_THAT(tables.results + tables.histograms, Not(HasSubstr("inf")));
  EXPECT_THAT(tables.histograms, Not(HasSubstr(",,")));
  return tables;
}

// Of meshes and scans, in all metrics; 2^300 to let 1e-12 vanish, which kl_smoothed adds to values.
TEST(HostileValues, OfGroundTruthAreScoredLikeAnyMultipleOfThem) {
  const Workspace toy(kAllMetrics);
  const fs::path file = toy.data() / "Distributions/2.val";
  const ScalarField values = values_in(file);
  const auto tables_at = [&](int power) {
    write_file(file, lines_of(spread(values, power)));
    return tables_of(toy);
  };
  EXPECT_EQ(tables_at(1023), tables_at(300));

  const auto tables_of_constant = [&](double value) {
    write_file(file, lines_of(ScalarField(values.size(), value)));
    return tables_of(toy);
  };
  EXPECT_EQ(tables_of_constant(0x1p1023), tables_of_constant(0x1p300));
}

// Several files of one item, of viewers who predict each other.
TEST(HostileValues, OfViewersAreScoredLikeAnyMultipleOfThem) {
  const Workspace toy;
  toy.write("viewers.yaml",
            "places:\n  - meshes: Meshes/*.off\n    truth: {saliency: \"views/{item}_{viewer}.val\"}\n");
  toy.configure(fmt::format("metrics: all\ndataset: {{scans: false, layout: '{}'}}\nmodels: {{PS: , HS: }}\n",
                            (toy / "viewers.yaml").string()));
  const auto tables_at = [&](int power) {
    for (const char* name : {"1", "2"}) {
      const ScalarField values = values_in(toy.data() / "Distributions" / (std::string(name) + ".val"));
      fs::create_directories(toy.data() / "views");
      for (int viewer = 0; viewer < 4; ++viewer) {
        ScalarField seen = values;
        for (auto i = static_cast<std::size_t>(viewer); i < seen.size(); i += 5) seen[i] *= 0.5;
        write_file(toy.data() / fmt::format("views/{}_{}.val", name, viewer),
                   lines_of(spread(seen, name[0] == '2' ? power : 300)));
      }
    }
    return tables_of(toy);
  };
  EXPECT_EQ(tables_at(1023), tables_at(300));
}

TEST(HostileValues, APointFarAwayFailsItsItemAndNoOther) {
  const Workspace toy;
  toy.write("gaze.yaml",
            "places:\n  - meshes: Meshes/*.off\n    truth: {saliency: \"gaze/{item}.csv\"}\n"
            "values: {per: point, points: [1, 2, 3], column: 4}\n");
  toy.configure(fmt::format("dataset: {{layout: '{}'}}\nscan: {{step_degrees: 1}}\nmodels: {{PS: , RS: }}\n",
                            (toy / "gaze.yaml").string()));
  fs::create_directories(toy.data() / "gaze");
  std::string samples;
  for (const Vec3& v : shapes::bumpy_sphere(2).vertices)
    samples += fmt::format("{} {} {} {}\n", v.x(), v.y(), v.z(), v.z() * v.z());
  write_file(toy.data() / "gaze/1.csv", samples);
  fs::rename(toy.data() / "Meshes/2.off", toy / "2.off");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string alone = toy.results();

  fs::rename(toy / "2.off", toy.data() / "Meshes/2.off");
  for (const char* far : {"1e300 0 0 1\n", "0 0 -1e151 1\n", "0 1.7e308 0 1\n"}) {
    write_file(toy.data() / "gaze/2.csv", samples + far);
    const Outcome run = toy.salbench("run");
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(lines_with(run.err, "error: "),
                AllOf(SizeIs(1),
                      Each(AllOf(HasSubstr("error: 2: "), HasSubstr("2.csv:163: a coordinate is larger")))))
        << run.err;
    EXPECT_EQ(toy.results(), alone);
  }
  write_file(toy.data() / "gaze/2.csv", samples + "0 1e150 0 1\n");
  EXPECT_EQ(toy.salbench("run").status, 0);
}

}  // namespace
}  // namespace salbench
