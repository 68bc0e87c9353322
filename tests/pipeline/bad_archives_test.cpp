// SPDX-License-Identifier: GPL-3.0-or-later
// Archives in which something is missing or wrong, in a run: one error that names file, line and remedy, and
// the other items go on. tests/datasets has what each importer says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/results/record.h"
#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

// Four meshes, of which "bee" is spoilt.
class Archive : public DataSets {
 protected:
  Archive() {
    for (const char* name : {"ant", "bee", "cat", "dog"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
      data_.write(fmt::format("maps/{}.txt", name), "0\n1\n2\n3\n");
      data_.write(fmt::format("seen/{}.txt", name), "1\n1\n1\n0\n");
      data_.write(fmt::format("clicks/{}_0.pid", name), "1\n2\n");
    }
  }
  std::string described(const std::string& more = "",
                        const std::string& truth = "saliency: 'maps/{item}.txt'") {
    return description("places:\n  - meshes: off/*\n    truth: {" + truth + "}\n" + more);
  }
};

TEST_F(Archive, FailsTheSpoiltItemByNameAndNoOther) {
  struct Case {
    const char *file, *text, *truth, *more, *says;
  };
  const char *const kMap = "saliency: 'maps/{item}.txt'",
                    *const kMasked = "saliency: 'maps/{item}.txt', mask: 'seen/{item}.txt'",
                    *const kPicks = "picks: 'clicks/{item}_{participant}.pid'";
  const Case cases[] = {
      {"maps/bee.txt", "0\n1\n2\n", kMap, "values: {unseen: -1}",
       "maps/bee.txt:3: the file has 3 values, but the mesh has 4 vertices"},
      {"maps/bee.txt", "0\n1\n2\n3\n4\n", kMap, "values: {per: face}",
       "maps/bee.txt:5: the file has 5 values, but the mesh has 4 faces"},
      {"maps/bee.txt", "0\n1\nx\n3\n", kMap, "values: {unseen: -1}", "maps/bee.txt:3: \"x\" is not a number"},
      {"maps/bee.txt", "0,1\n", kMap, "values: {column: 1}", "maps/bee.txt:1: the file has 1 values"},
      {"maps/bee.txt", "\x89HDF\r\n\x1a\n", kMap, "values: {unseen: -1}", "maps/bee.txt"},
      {"maps/bee.txt", "MATLAB 5.0 MAT-file", kMap, "values: {variable: map}", "maps/bee.txt"},
      {"off/bee.off", "OFF\n4 4 0\n0 0 0\n", kMap, "values: {unseen: -1}",
       "off/bee.off:3: the file ends after 1 of 4 vertices"},
      {"seen/bee.txt", "1\n1\n1\n", kMasked, "", "seen/bee.txt:3: the file has 3 values"},
      {"seen/bee.txt", "1\n1\n0.5\n0\n", kMasked, "", "seen/bee.txt:3: a mask has 0 for hidden"},
      {"seen/bee.txt", "0\n0\n0\n0\n", kMasked, "", "seen/bee.txt: hides everything"},
      {"seen/bee.txt", nullptr, kMasked, "", "seen/bee.txt: is missing, the mask of"},
      {"clicks/bee_0.pid", "1\n0\n", kPicks, "indices: {base: 1}",
       "clicks/bee_0.pid:2: vertex 0 is out of range: the mesh has 4 vertices, numbered from 1"},
      {"clicks/bee_0.pid", "", kPicks, "indices: {base: 1}", "clicks/bee_0.pid: nobody picked a point"},
      {"splits.csv", "item,split\nbee,test\nbee,train\n", kMap, "splits: {file: splits.csv}",
       "splits.csv:3: 'bee' is in the split 'train'"},
  };
  for (const Case& spoilt : cases) {
    SCOPED_TRACE(fmt::format("{} {}", spoilt.file, spoilt.more));
    const std::string before =
        std::filesystem::exists(data_ / spoilt.file) ? read_file(data_ / spoilt.file) : "";
    if (spoilt.text != nullptr)
      data_.write(spoilt.file, spoilt.text);
    else
      std::filesystem::remove(data_ / spoilt.file);
    run(described(spoilt.more, spoilt.truth));
    EXPECT_THAT(failures(), ElementsAre(HasSubstr(place(spoilt.says))));
    EXPECT_THAT(toy_->results(), SizeIs(3)) << "RS of the others";
    data_.write(spoilt.file, before);
    if (before.empty()) std::filesystem::remove(data_ / spoilt.file);
  }
}

TEST_F(Archive, WhoseGroundTruthCannotBeUsedStillHasMaps) {
  data_.write("splits.csv", "item,split\nbee,test\nbee,train\n");
  run(described("splits: {file: splits.csv}\nvalues: {unseen: -1}\n"));
  EXPECT_EQ(toy_->decision("ground_truth", 1).verdict, Verdict::failed);
  EXPECT_EQ(toy_->decision("map.RS", 1).verdict, Verdict::done);
}

TEST_F(Archive, WhoseSplitNamesUnknownItems) {
  data_.write("splits.csv", "item,split\nant,test\nbe,test\ncat,train\ndogg,train\nee,test\n");
  const std::string own = described("splits: {file: splits.csv}\n");
  const std::string error = place("splits.csv") +
                            ":3: the split 'test' names 'be', which is no item of the data set "
                            "(2 such names): correct the name, or add its files";
  run(own, "scans: false, split: test");
  EXPECT_THAT(toy_->inputs.errors, ElementsAre(error));
  EXPECT_THAT(toy_->inputs.notes, Not(Contains(HasSubstr("'be'"))));
  EXPECT_THAT(toy_->inputs.notes,
              Contains(StartsWith(place("splits.csv") + ":5: the split 'train' names 'dogg'")));
  EXPECT_THAT(units(), ElementsAre("ant")) << "the others go on";
  EXPECT_THAT(failures(), IsEmpty());
  run(own);
  EXPECT_THAT(toy_->inputs.errors, IsEmpty()) << "no split is asked for";
  EXPECT_THAT(toy_->inputs.notes,
              Contains(StartsWith(place("splits.csv") + ":3: the split 'test' names 'be'")));
}

TEST_F(Archive, InMixedUnits) {
  Mesh mesh = shapes::tetrahedron();
  for (Vec3& v : mesh.vertices) v *= 1000;
  data_.write("off/cat.off", off_text(mesh));
  run(described("units: mm\n"));
  EXPECT_THAT(failures(), ElementsAre(AllOf(StartsWith(place("off/cat.off") + ": its diagonal, "),
                                            HasSubstr("1e+03 times the median"),
                                            HasSubstr("own.yaml:4 says: scale it"))));
  run(described());
  EXPECT_THAT(failures(), IsEmpty());
}

TEST_F(Archive, ThatIsNoneIsRefusedAsAWhole) {
  const auto refused = [&](const std::string& layout, const std::string& why) {
    EXPECT_THAT([&] { run(layout); }, ThrowsMessage<InputError>(HasSubstr(why))) << layout;
  };
  refused(described("units: miles\n"), "own.yaml:4: units is 'miles', expected one of m, dm, cm, mm");
  refused(description("places: [{meshes: 'of/*'}]\n"), "no .off, .obj or .ply meshes found");
  refused("3dvaa", "there is no layout '3dvaa'; did you mean '3dva'?");
  refused("3dva", place("3DModels-Simplif"));
}

}  // namespace
}  // namespace salbench
