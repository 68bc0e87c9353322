// SPDX-License-Identifier: GPL-3.0-or-later
// Separately scored views of a shape.

#include "cache/folder_store.h"
#include "pipeline/results/tables.h"
#include "pipeline/rules/given_maps.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const Mesh kTetrahedron = shapes::tetrahedron();

class WithViews : public DataSets {
 protected:
  WithViews() {
    write_view("1", "1\n2\n3\n4\n", "1\n1\n0\n1\n");
    write_view("2", "5\n0\n0\n8\n", "1\n1\n1\n0\n");
    data_.write("off/cat.off", off_text(kTetrahedron));
  }
  void write_view(const std::string& view, const std::string& values, const std::string& mask) {
    data_.write("fix/cat_" + view + ".txt", values);
    data_.write("seen/cat_" + view + "_visibility.txt", mask);
  }
  std::string views() {
    return data_set(R"(
def items(root):
    return [Item(f"cat_{one.view}", [f"{root}/off/cat.off", one.path, f"{root}/seen/cat_{one.view}_visibility.txt"],
                 shape="cat", view=one.view)
            for one in match(root, "fix/cat_{view}.txt")]

def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = values(item.files[1], len(shape.points))
    shape.ground_truth[~mask(item.files[2], len(shape.points))] = float("nan")
    return shape
)");
  }
};

TEST_F(WithViews, AreUnitsOfTheirOwnIfTheyAreScored) {
  run(views());
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(units(), ElementsAre("cat_1", "cat_2"));
  EXPECT_EQ(toy_->inputs.text(), "2 views of 1 mesh");
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, IsNan(), 4));
  EXPECT_THAT(truth(1).saliency, ElementsAre(5, 0, 0, IsNan()));
  std::set<std::pair<std::string, std::string>> rows;
  for (const ResultRow& row : toy_->results()) {
    rows.emplace(row.item, row.view);
    EXPECT_EQ(row.scores.n_points, 3);
  }
  EXPECT_THAT(rows, ElementsAre(std::pair("cat", "1"), std::pair("cat", "2")));
  for (const auto& row : means_table(toy_->results(), metrics()).rows)
    if (row.at(1) == Cell(std::string("cc"))) {
      EXPECT_EQ(row.at(3), Cell(std::int64_t{1})) << "the mesh is the unit of inference";
    }
}

// A family is claimed by its mesh: threads that reach another view of it take up other work first.
TEST_F(WithViews, ShareWhatIsComputedOfTheirMesh) {
  for (int view = 3; view < 9; ++view) write_view(std::to_string(view), "1\n2\n3\n4\n", "1\n1\n0\n1\n");
  FolderStore store(folder_ / "cache", Access::read_write);
  ToyRun toy(data_.path(), store,
             fmt::format("dataset: {{layout: {}, scans: false}}\nmodels: {{MS: , RS: }}\n", views()));
  toy.run(4);
  const auto computed = [&](std::string_view stage) {
    return toy.resolver->records()[toy.index(stage)].seconds.size();
  };
  EXPECT_EQ(computed("import"), 8U);
  EXPECT_EQ(computed("map.MS"), 1U);
  EXPECT_EQ(computed("map.RS"), 8U) << "random numbers are of the unit";
  EXPECT_EQ(computed("ground_truth"), 8U) << "each form names its view";
}

TEST_F(WithViews, AreChosenByTheirNameOrByThatOfTheirMesh) {
  const Dataset dataset = find_dataset(data_.path(), views(), front_of_tests());
  EXPECT_EQ(read_inputs(dataset, "cat").count(kMeshes), 2U);
  EXPECT_EQ(read_inputs(dataset, "cat_2").count(kMeshes), 1U);
}

TEST_F(WithViews, ShareAGivenMapUnlessTheyHaveTheirOwn) {
  const Inputs inputs = read_inputs(find_dataset(data_.path(), views(), front_of_tests()));
  const auto maps = [&] {
    const auto given = find_given_maps(folder_ / "given", false);
    std::vector<std::string> places;
    const auto all = map_files(given, inputs.units, {kMeshes}).at(kMeshes);
    for (const std::vector<File>& files : *all)
      places.push_back(std::filesystem::path(files.at(0).place).filename());
    return places;
  };
  folder_.write("given/cat.val", "1\n2\n3\n4\n");
  EXPECT_THAT(maps(), ElementsAre("cat.val", "cat.val"));
  folder_.write("given/cat_2.val", "1\n2\n3\n4\n");
  EXPECT_THAT(maps(), ElementsAre("cat.val", "cat_2.val"));
}

}  // namespace
}  // namespace salbench
