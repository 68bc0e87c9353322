// SPDX-License-Identifier: GPL-3.0-or-later
// Import is a stage like any other: its inputs are in its key, and its results are reused.

#include "pipeline/inputs/item_reader.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr const char* kItems = R"(
def items(root):
    return [Item(one.item, [one.path, f"{root}/maps/{one.item}.csv"]) for one in match(root, "off/{item}.off")]
)";

// `column` of each shape's table is its ground truth; `more` changes the shape before it is returned.
std::string read_by(const std::string& column = "a", const std::string& more = "") {
  return R"(
def read(item):
    shape = mesh(item.files[0])
    shape.ground_truth = numbers(item.files[1], [")" +
         column + "\"])[:, 0]\n" + more + "    return shape\n";
}

class Imported : public DataSets {
 protected:
  Imported() {
    for (const char* name : {"ant", "bee", "cat"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
      data_.write(fmt::format("maps/{}.csv", name), fmt::format("a,b\n0,1\n1,2\n2,3\n3,{}\n", int{name[0]}));
    }
  }
  // Stages stored by a run over the layout, in order.
  std::vector<std::string> stored(const std::string& layout) {
    std::vector<std::string> stages = run(layout);
    EXPECT_THAT(failures(), IsEmpty());
    for (std::string& saved : stages) saved = saved.substr(0, saved.find('@'));
    return stages;
  }
  std::size_t count(const std::vector<std::string>& stages, const char* stage) {
    return static_cast<std::size_t>(std::ranges::count(stages, stage));
  }
  void equal_columns() {
    for (const char* name : {"ant", "bee", "cat"})
      data_.write(fmt::format("maps/{}.csv", name),
                  fmt::format("a,b\n0,0\n1,1\n2,2\n{0},{0}\n", int{name[0]}));
  }
  // The first item as a run reads it, from files with this content.
  ShapeInForm read_first(const std::vector<FileData>& data) {
    const Family& family = toy_->inputs.units.families()[0];
    return ItemReader(front_of_tests(), toy_->inputs.read).read({family.source, family.name, data});
  }

  const std::string own_ = data_set(kItems + read_by());
};

TEST_F(Imported, ItemsAreImportedOnceAndFoundAgain) {
  EXPECT_EQ(count(stored(own_), "import"), 3U);
  EXPECT_THAT(stored(own_), IsEmpty());
  data_.write("maps/bee.csv", "a,b\n0,1\n1,2\n2,3\n7,5\n");
  const std::vector<std::string> again = stored(own_);
  EXPECT_EQ(count(again, "import"), 1U);
  EXPECT_EQ(count(again, "mesh"), 1U);
  EXPECT_EQ(count(again, "map.RS"), 0U) << "early cut-off: the mesh is as before";
}

TEST_F(Imported, AnotherTextImportsAgainAndNothingElseWhereTheShapesAreTheSame) {
  equal_columns();
  stored(own_);
  EXPECT_THAT(stored(data_set(kItems + read_by("b"))), AllOf(SizeIs(3), Each("import")));
  EXPECT_THAT(stored(data_set(kItems + read_by("b", "    shape.ground_truth[2] = float('nan')\n"))),
              Contains("ground_truth"));
}

TEST_F(Imported, AnotherVersionImportsAgainAndAnotherTextOfOneDoesNot) {
  equal_columns();
  const std::string text = kItems + read_by();
  stored(data_set("VERSION = 1\n" + text));
  EXPECT_THAT(stored(data_set("VERSION = 2\n" + text)), AllOf(SizeIs(3), Each("import")));
  EXPECT_THAT(stored(data_set("VERSION = 2\n" + text + "# the same\n")), IsEmpty());
  EXPECT_THAT(stored(data_set("VERSION = 2\n" + (kItems + read_by("b")))), IsEmpty()) << "as it promises";
}

// Names of files, classes, splits, notes and remarks, and the folder's location.
TEST_F(Imported, NoLabelIsPartOfAKey) {
  stored(data_set("VERSION = 1\n" + (kItems + read_by())));
  std::filesystem::rename(data_ / "off", data_ / "meshes");
  std::filesystem::rename(data_ / "maps", data_ / "values");
  for (const char* name : {"ant", "bee", "cat"}) {
    std::filesystem::rename(data_ / fmt::format("meshes/{}.off", name),
                            data_ / fmt::format("meshes/the {}.OFF", name));
    std::filesystem::rename(data_ / fmt::format("values/{}.csv", name),
                            data_ / fmt::format("values/{} by hand.txt", name));
  }
  EXPECT_THAT(stored(data_set(R"("""Another title."""
VERSION = 1
LICENCE = "CC0"

def items(folder):
    names = ["ant", "bee", "cat"]
    return Listing([Item(name, [f"{folder}/meshes/the {name}.OFF", f"{folder}/values/{name} by hand.txt"],
                         category="insect", split="test") for name in names],
                   notes=["a note"], read=["README"], splits_where="a place", remark="TRUTH: a remark")
)" + read_by("a", "    shape.remarks = ['a remark']\n"))),
              IsEmpty());
  const Item& item = item_of(toy_->inputs.units, mesh_unit(0));
  EXPECT_EQ(item.category + item.split + toy_->inputs.remark, "insecttestTRUTH: a remark");
}

TEST_F(Imported, WhatReadIsToldIsPartOfTheKey) {
  stored(own_);
  const auto with = [&](const std::string& info) {
    return data_set(
        "VERSION = 1\ndef items(root):\n    return [Item('ant', [f'{root}/off/ant.off', "
        "f'{root}/maps/ant.csv'], info=" +
        info + ")]\n" + read_by("a", "    shape.ground_truth[0] = item.info['first']\n"));
  };
  EXPECT_THAT(stored(with("{'first': 7}")), Contains("import"));
  EXPECT_THAT(stored(with("{'first': 8}")), Contains("import"));
  EXPECT_EQ(truth(0).saliency[0], 8);
  EXPECT_THAT(stored(with("{'first': 7}")), IsEmpty());
}

TEST_F(Imported, PlansListAndImportNothing) {
  const ToyRun toy(data_.path(), store_, fmt::format("dataset: {{layout: {}}}\nmodels: {{RS: }}\n", own_));
  EXPECT_TRUE(toy.decision("import", 0).open() && !toy.decision("import", 0).waits());
  EXPECT_TRUE(toy.decision("mesh", 0).waits());
  EXPECT_THAT(store_.take_saved(), IsEmpty());
}

TEST_F(Imported, TheShapeHasTheGroundTruthOfEachItem) {
  run(data_set(kItems + read_by("b")));
  EXPECT_EQ(truth(1).saliency, (ScalarField{1, 2, 3, 'b'}));
  const File& file = toy_->inputs.shape_files->at(0).at(1);
  EXPECT_EQ(file.name, "file 1") << "as the key has it";
  EXPECT_EQ(std::filesystem::path(file.place).filename(), "ant.csv");
}

// A file is read for the key, and again by Python; it may also stand under another's name by then.
TEST_F(Imported, AFileThatChangesInBetweenFailsItsItem) {
  run(own_);
  std::vector<FileData> data = read_files(toy_->inputs.shape_files->at(0));
  EXPECT_EQ(read_first(data).truths.size(), 1U);
  data_.write("maps/ant.csv", "a,b\n0,1\n1,2\n2,3\n3,4\n");
  EXPECT_THAT([&] { read_first(data); }, Refuses(place("maps/ant.csv") + ": changed while it was read"));
  std::swap(data[0], data[1]);
  EXPECT_THAT([&] { read_first(data); }, Refuses(place("off/ant.off") + ": changed while it was read"));
}

// For "bee", as changed by `more`.
TEST_F(Imported, AShapeThatIsNotAsItsItemSaysFailsAlone) {
  const auto failure = [&](const std::string& more, const std::string& item = "") {
    run(data_set(
        "def items(root):\n    return [Item(name, [f'{root}/off/{name}.off', f'{root}/maps/{name}.csv']" +
        item + ") for name in ('ant', 'bee')]\n" + read_by("a", "    " + more + "\n")));
    EXPECT_EQ(toy_->decision("ground_truth", 0).state, State::known);
    const std::vector<std::string> causes = failures();
    return causes.size() == 1 ? causes[0] : fmt::format("{} failures", causes.size());
  };
  EXPECT_THAT(failure("if item.name == 'bee': shape.faces = None"), HasSubstr("bee: is a point cloud"));
  EXPECT_THAT(failure("if item.name == 'bee': shape.ground_truth = None"), HasSubstr("bee"));
  EXPECT_THAT(failure("shape.participants = [[0]] * (2 if item.name == 'bee' else 3)", ", participants=3"),
              HasSubstr("has 2 picks of participants"));
  EXPECT_THAT(failure("if item.name == 'bee': shape.faces[0] = 4"), HasSubstr("\"shape/faces\": 4 "));
  EXPECT_THAT(failure("if item.name == 'bee': raise ValueError('two\\nlines')"),
              HasSubstr("bee.off: read() raised ValueError: two lines ("));
}

TEST_F(Imported, NamesMayBeAnyBytes) {
  for (const char* name : {"\xff\xfe", "\xc3\xa9t\xc3\xa9", "a b'c\"d\\e", "\xf0\x9f\x90\x84"}) {
    data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
    data_.write(fmt::format("maps/{}.csv", name), "a,b\n0,1\n1,2\n2,3\n3,4\n");
  }
  run(own_);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(units(), IsSupersetOf({"\xff\xfe", "\xc3\xa9t\xc3\xa9", "a b'c\"d\\e", "\xf0\x9f\x90\x84"}));
  EXPECT_THAT(toy_->results(), SizeIs(7));
}

}  // namespace
}  // namespace salbench
