// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers too large or too small to compute with: whatever one item holds, the run ends, and the others have
// the scores that they have without it.
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

// The ground truth of one item.
TEST(HostileValues, AMagnitudeBeyondTheGateFailsItsItemAndNoOther) {
  const Workspace toy(kAllMetrics);
  const fs::path file = toy.data() / "Distributions/2.val";
  const ScalarField values = values_in(file);
  for (const double factor : {1e200, 1e-200}) {
    ScalarField scaled = values;
    for (double& value : scaled) value *= factor;
    write_file(file, lines_of(scaled));
    const Outcome run = toy.salbench("run");
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(run.err,
                AllOf(HasSubstr("2.val"), HasSubstr("the largest magnitude, expected 1e-100 to 1e+100")));
    EXPECT_THAT(toy.results(),
                AllOf(HasSubstr("meshes,1,"), Not(HasSubstr("meshes,2,")), Not(HasSubstr("inf"))));
  }
}

TEST(HostileValues, APointFarAwayFailsItsItemAndNoOther) {
  const Workspace toy;
  toy.write("gaze.py", R"(from salbench.datasets import Item, match, mesh, numbers
from salbench.datasets.reading import from_points

def items(root):
    return [Item(one.item, [one.path, f"{root}/gaze/{one.item}.csv"]) for one in match(root, "Meshes/{item}.off")]

def read(item):
    shape, samples = mesh(item.files[0]), numbers(item.files[1], 4)
    shape.truth = from_points(shape, samples[:, :3], samples[:, 3])
    return shape
)");
  toy.configure(fmt::format("dataset: {{layout: '{}'}}\nscan: {{step_degrees: 1}}\nmodels: {{PS: , RS: }}\n",
                            (toy / "gaze.py").string()));
  fs::create_directories(toy.data() / "gaze");
  std::string samples;
  for (const Vec3& v : shapes::bumpy_sphere(2).vertices)
    samples += fmt::format("{} {} {} {}\n", v.x(), v.y(), v.z(), v.z() * v.z());
  write_file(toy.data() / "gaze/1.csv", samples);
  fs::rename(toy.data() / "Meshes/2.off", toy / "2.off");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string alone = toy.results();

  fs::rename(toy / "2.off", toy.data() / "Meshes/2.off");
  for (const char* far : {"1e300 0 0 1\n", "0 0 -1e51 1\n", "0 1.7e308 0 1\n"}) {
    write_file(toy.data() / "gaze/2.csv", samples + far);
    const Outcome run = toy.salbench("run");
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(lines_with(run.err, "error: "),
                AllOf(SizeIs(1),
                      Each(AllOf(HasSubstr("error: 2: "),
                                 HasSubstr("samples must have finite coordinates of at most 1e50, not ")))))
        << run.err;
    EXPECT_EQ(toy.results(), alone);
  }
  write_file(toy.data() / "gaze/2.csv", samples + "0 1e50 0 1\n");
  EXPECT_EQ(toy.salbench("run").status, 0);
}

}  // namespace
}  // namespace salbench
