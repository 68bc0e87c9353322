// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over the layouts listed by the program itself, and over shapes read by Python, whose readers are
// tested in tests/datasets.
#include "tests/pipeline/data_sets.h"

#include "stages/core/seen.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const Mesh kSphere = shapes::bumpy_sphere(2);

// One value per vertex, for a different shape each time.
ScalarField heights(const Mesh& mesh, double offset) {
  ScalarField values;
  for (const Vec3& v : mesh.vertices) values.push_back(std::abs(v.z() + offset));
  return values;
}

std::string lines_of(const ScalarField& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}\n", value);
  return text;
}

// --- layouts -------------------------------------------------------------------------

TEST_F(DataSets, Schelling) {
  write_toy_item(data_.path(), "21", kSphere);
  for (const char* layout : {"schelling", "automatic"}) {
    run(layout);
    EXPECT_THAT(failures(), IsEmpty());
    EXPECT_THAT(truth().picks, SizeIs(4));
    EXPECT_EQ(item_of(toy_->inputs.units, mesh_unit(0)).category, "cup");
    EXPECT_TRUE(std::isfinite(score_of("HS", "nss")));
  }
}

// --- viewers ----------------------------------------------------------------------------------------------

constexpr const char* kViewers = R"(
def items(root):
    maps = [one.path for one in match(root, "maps/cat_{viewer}.csv")]
    return [Item("cat", [f"{root}/off/cat.off", *maps], viewers=len(maps))]

def read(item):
    shape = mesh(item.files[0])
    shape.viewers = [values(path, len(shape.points)) for path in item.files[1:]]
    shape.ground_truth = sum(shape.viewers) / len(shape.viewers)
    return shape
)";

TEST_F(DataSets, ViewersMakeTheGroundTruthAndHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  for (int k = 0; k < 5; ++k)
    data_.write(fmt::format("maps/cat_{}.csv", k), lines_of(heights(kSphere, 0.1 * k)));
  run(data_set(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, SizeIs(5));
  EXPECT_EQ(truth().viewers[3], heights(kSphere, 0.1 * 3));
  EXPECT_EQ(truth().saliency, mean_of_seen(truth().viewers, std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_GT(score_of("HS", "cc"), 0.5) << "people who see much the same agree";
  EXPECT_THAT(score_of("HS", "nss"), IsNan()) << "nobody picked a point";
}

TEST_F(DataSets, OneViewerIsNoHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  data_.write("maps/cat_0.csv", lines_of(heights(kSphere, 0)));
  run(data_set(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_EQ(truth().saliency, heights(kSphere, 0));
  ASSERT_THAT(toy_->results(), SizeIs(1));
  EXPECT_EQ(toy_->results()[0].model, "RS");
}

// --- keys -------------------------------------------------------------------------------------------------

TEST_F(DataSets, OfPythonWithoutAReaderHaveTheKeysOfALayout) {
  write_toy_item(data_.path(), "21", kSphere);
  EXPECT_THAT(run("schelling"), Not(IsEmpty()));
  const auto names = [&] {
    std::vector<std::string> found;
    for (const File& file : toy_->inputs.truth_files->at(0)) found.push_back(file.name);
    return found;
  };
  EXPECT_THAT(names(), ElementsAre("saliency file", "picks 0", "picks 1", "picks 2", "picks 3"));
  EXPECT_THAT(run(data_set(R"(
def items(root):
    return [Item(one.item, [one.path], saliency=f"{root}/Distributions/{one.item}.val",
                 picks=[pick.path for pick in match(root, "RawData/{item}_{participant}.pid", [one.item])])
            for one in match(root, "Meshes/{item}.off")]
)")),
              IsEmpty());
  EXPECT_THAT(names(), SizeIs(5));
}

}  // namespace
}  // namespace salbench
