// SPDX-License-Identifier: GPL-3.0-or-later
// Import is a stage like any other: what it reads is in its key, and what it made is found again.
#include <atomic>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/importer.h"
#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"

namespace salbench {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

class Imported : public DataSets {
 protected:
  Imported() {
    const Mesh mesh = shapes::tetrahedron();
    for (const char* name : {"ant", "bee", "cat"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(mesh));
      data_.write(fmt::format("maps/{}.csv", name), fmt::format("a,b\n0,1\n1,2\n2,3\n3,{}\n", int{name[0]}));
    }
  }
  std::string described(const std::string& values = "column: a") {
    return description("places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\nvalues: {" +
                       values + "}\n");
  }
  // Stages of what a run over the layout stored, one after the other.
  std::vector<std::string> stored(const std::string& layout) {
    store_.take_saved();
    run(layout);
    EXPECT_THAT(failures(), IsEmpty());
    std::vector<std::string> stages;
    for (const std::string& saved : store_.take_saved()) stages.push_back(saved.substr(0, saved.find('@')));
    return stages;
  }
  std::size_t count(const std::vector<std::string>& stages, const char* stage) {
    return static_cast<std::size_t>(std::ranges::count(stages, stage));
  }
};

TEST_F(Imported, ItemsAreImportedOnceAndFoundAgain) {
  EXPECT_EQ(count(stored(described()), "import"), 3U);
  EXPECT_THAT(stored(described()), IsEmpty());
  data_.write("maps/bee.csv", "a,b\n0,1\n1,2\n2,3\n7,5\n");
  const std::vector<std::string> again = stored(described());
  EXPECT_EQ(count(again, "import"), 1U);
  EXPECT_EQ(count(again, "mesh"), 1U);
  EXPECT_EQ(count(again, "map.RS"), 0U) << "early cut-off: the mesh is as before";
}

TEST_F(Imported, AnotherFormatImportsAgainAndNothingElseWhereTheFormIsTheSame) {
  for (const char* name : {"ant", "bee", "cat"})
    data_.write(fmt::format("maps/{}.csv", name), fmt::format("a,b\n0,0\n1,1\n2,2\n{0},{0}\n", int{name[0]}));
  stored(described());
  EXPECT_THAT(stored(described("column: b")), SizeIs(3));
  EXPECT_THAT(stored(described("column: b, unseen: 2")), Contains("ground_truth"));
}

TEST_F(Imported, PlansListAndImportNothing) {
  const std::string layout = described();
  const ToyRun toy(data_.path(), store_,
                   fmt::format("dataset: {{layout: {}, scans: false}}\nmodels: {{RS: }}\n", layout));
  EXPECT_TRUE(toy.decision("import", 0).open() && !toy.decision("import", 0).waits());
  EXPECT_TRUE(toy.decision("mesh", 0).waits());
  EXPECT_THAT(store_.take_saved(), IsEmpty());
}

TEST_F(Imported, TheFormHasTheGroundTruthOfEachItem) {
  run(described("column: b"));
  EXPECT_EQ(truth(1).saliency, (ScalarField{1, 2, 3, 'b'}));
  EXPECT_EQ(toy_->inputs.shape_files->at(0).at(1).name, "saliency file (column: b), rows by their numbers");
}

// A file is read for the key, and again by the importer.
TEST_F(Imported, AFileThatChangesInBetweenFailsItsItem) {
  run(described());
  const std::any& source = toy_->inputs.units.families()[0].source;
  const std::string name = "ant";
  std::vector<FileData> data = read_files(toy_->inputs.shape_files->at(0));
  const Importer importer(front_of_tests(), toy_->inputs.importer);
  EXPECT_EQ(importer.item({source, name, data}).truths.size(), 1U);
  data_.write("maps/ant.csv", "a,b\n0,1\n1,2\n2,3\n3,4\n");
  EXPECT_THAT(
      [&] {
        importer.item({source, name, data});
      },
      ThrowsMessage<InputError>(StartsWith(place("maps/ant.csv") + ": changed while it was imported")));
}

// Each file was there, under another's name.
TEST_F(Imported, FilesThatAreExchangedInBetweenFailTheirItem) {
  run(described());
  std::vector<FileData> data = read_files(toy_->inputs.shape_files->at(0));
  std::swap(data[0], data[1]);
  const std::string name = "ant";
  EXPECT_THAT(
      [&] {
        Importer(front_of_tests(), toy_->inputs.importer)
            .item({toy_->inputs.units.families()[0].source, name, data});
      },
      ThrowsMessage<InputError>(StartsWith(place("off/ant.off") + ": changed while it was imported")));
}

TEST_F(Imported, NamesMayBeAnyBytes) {
  for (const char* name : {"\xff\xfe", "\xc3\xa9t\xc3\xa9", "a b'c\"d\\e", "\xf0\x9f\x90\x84"}) {
    data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
    data_.write(fmt::format("maps/{}.csv", name), "a,b\n0,1\n1,2\n2,3\n3,4\n");
  }
  run(described());
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(units(),
              testing::IsSupersetOf({"\xff\xfe", "\xc3\xa9t\xc3\xa9", "a b'c\"d\\e", "\xf0\x9f\x90\x84"}));
  EXPECT_THAT(toy_->results(), SizeIs(7));
}

}  // namespace
}  // namespace salbench
