// SPDX-License-Identifier: GPL-3.0-or-later
// Archives in which something is missing or wrong: one error that names file, line and remedy, and the other
// items go on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/inputs/inspection.h"
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

// Two meshes with two views each, in the names of 3DVA.
class Archive : public DataSets {
 protected:
  Archive() {
    for (const char* mesh : {"bunny", "dragon"}) {
      data_.write(fmt::format("3DModels-Simplif/{}.off", mesh), off_text(shapes::tetrahedron()));
      for (const int view : {300, 413}) {
        data_.write(fixations(mesh, view), "1\n2\n3\n4\n");
        data_.write(mask(mesh, view), "1\n1\n1\n0\n");
      }
    }
  }
  static std::string fixations(const std::string& mesh, int view) {
    return fmt::format("FixationMaps/{}_{}norm.txt", mesh, view);
  }
  static std::string mask(const std::string& mesh, int view) {
    return fmt::format("CentricityAndVisibilityMaps/{}_{}_visibility.txt", mesh, view);
  }
  // Runs, and returns the only failure, once all other views have scores.
  std::string only_failure(const std::string& layout = "3dva", const std::string& more = "scans: false") {
    run(layout, more);
    const std::size_t views = toy_->inputs.units.families().size();
    EXPECT_THAT(failures(), SizeIs(1));
    EXPECT_THAT(toy_->results(), SizeIs(views - 1)) << "RS of all others; HS does not apply";
    return failures().at(0);
  }
};

TEST_F(Archive, ThatIsWholeHasNoFailure) {
  run("3dva");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(toy_->results(), SizeIs(4));
}

TEST_F(Archive, WithoutAMask) {
  std::filesystem::remove(data_ / mask("dragon", 413));
  EXPECT_THAT(only_failure(), AllOf(StartsWith(place(mask("dragon", 413)) + ": is missing, the mask of"),
                                    HasSubstr("add it"), HasSubstr("3dva.yaml:11")));
}

TEST_F(Archive, WithAWrongCountByOne) {
  data_.write(fixations("bunny", 300), "1\n2\n3\n4\n5\n");
  EXPECT_EQ(only_failure(),
            place(fixations("bunny", 300)) + ":5: the file has 5 values, but the mesh has 4 vertices");
  data_.write(fixations("bunny", 300), "1\n2\n3\n4\n");
  data_.write(mask("bunny", 300), "1\n0\n1\n");
  EXPECT_EQ(only_failure(),
            place(mask("bunny", 300)) + ":3: the file has 3 values, but the mesh has 4 vertices");
}

TEST_F(Archive, WithAViewWithoutGroundTruth) {
  std::filesystem::remove(data_ / fixations("bunny", 413));
  EXPECT_THAT(only_failure(),
              AllOf(StartsWith(place(fixations("bunny", 413)) + ": is missing, the ground truth"),
                    HasSubstr(place(mask("bunny", 413))), HasSubstr("add it, or take the mask"),
                    HasSubstr("3dva.yaml:10")));
  EXPECT_THAT(units(), ElementsAre("bunny_300", "bunny_413", "dragon_300", "dragon_413"));
}

TEST_F(Archive, WithAMaskThatHidesEverything) {
  data_.write(mask("bunny", 300), "0\n0\n0\n0\n");
  EXPECT_THAT(only_failure(),
              AllOf(StartsWith(place(mask("bunny", 300)) + ": hides everything"), HasSubstr("correct it")));
}

class FlatArchive : public DataSets {
 protected:
  FlatArchive() {
    for (const char* name : {"ant", "bee", "cat", "dog"}) {
      data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
      data_.write(fmt::format("maps/{}.txt", name), "0\n1\n2\n3\n");
    }
  }
  std::string described(const std::string& more) {
    return description("places:\n  - meshes: off/*\n    truth: {saliency: 'maps/{item}.txt'}\n" + more);
  }
};

TEST_F(FlatArchive, WhoseSplitNamesUnknownItems) {
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

TEST_F(FlatArchive, WithAnItemInTwoSplits) {
  data_.write("splits.csv", "item,split\nant,test\nbee,test\nant,train\n");
  run(described("splits: {file: splits.csv}\n"), "scans: false, split: test");
  EXPECT_THAT(failures(),
              ElementsAre(AllOf(StartsWith(place("splits.csv") + ":4: 'ant' is in the split 'train'"),
                                HasSubstr("keep one of them"))));
  EXPECT_EQ(truth(1).saliency, (ScalarField{0, 1, 2, 3}));
}

TEST_F(FlatArchive, InMixedUnits) {
  Mesh mesh = shapes::tetrahedron();
  for (Vec3& v : mesh.vertices) v *= 1000;
  data_.write("off/cat.off", off_text(mesh));
  const std::string own = described("units: mm\n");
  run(own);
  EXPECT_THAT(failures(), ElementsAre(AllOf(StartsWith(place("off/cat.off") + ": its diagonal, "),
                                            HasSubstr("1e+03 times the median"),
                                            HasSubstr("own.yaml:4 says: scale it"))));
  run(own, "scans: false, split: ''");
  EXPECT_THAT(toy_->results(), SizeIs(3));
  const DataInspection found = inspect_data(data_.path(), layouts_of(own));
  EXPECT_THAT(found.problems(), ElementsAre(StartsWith("cat: " + place("off/cat.off") + ": its diagonal")));
  const DataInspection plain = inspect_data(data_.path(), layouts_of(described("")));
  EXPECT_DOUBLE_EQ(found.items[0].diagonal, 0.001 * plain.items[0].diagonal) << "in metres";
  EXPECT_THAT(plain.problems(), ElementsAre(AllOf(StartsWith("cat: its diagonal"), HasSubstr("`units:`"))));
  EXPECT_THAT(plain.items[2].problem, IsEmpty()) << "without units it is a hint";
  run(described(""));
  EXPECT_THAT(failures(), IsEmpty());
}

TEST_F(FlatArchive, UnitsMustBeKnownAndScalesPositive) {
  const auto refused = [&](const std::string& more, const std::string& why) {
    EXPECT_THAT([&] { run(described(more)); },
                ThrowsMessage<ConfigError>(AllOf(HasSubstr("own.yaml:4"), HasSubstr(why))))
        << more;
  };
  refused("units: miles\n", "is 'miles', expected one of m, dm, cm, mm");
  refused("scale: 0\n", "scale must be a number above 0");
  refused("scale: -1\n", "scale must be a number above 0");
  refused("scale: .inf\n", "not a finite number");
  refused("values: {scale: 0}\n", "values.scale must be a number above 0");
  refused("values: {scale: .nan}\n", "not a finite number");
  EXPECT_THAT([&] { run(described("scale: 2\nunits: mm\n")); },
              ThrowsMessage<ConfigError>(HasSubstr("is there beside units")));
}

TEST_F(FlatArchive, PointsBesideValuesMayBeInAnotherUnit) {
  const Mesh mesh = shapes::tetrahedron();
  std::string lines = "x,y,z,s\n";
  for (const Vec3& v : mesh.vertices)
    lines += fmt::format("{},{},{},{}\n", 1000 * v.x(), 1000 * v.y(), 1000 * v.z(), v.x());
  for (const char* name : {"ant", "bee", "cat", "dog"}) data_.write(fmt::format("maps/{}.txt", name), lines);
  const std::string per_point = "values: {per: point, points: [x, y, z], column: s";
  run(described(per_point + "}\n"));
  EXPECT_THAT(failures(), SizeIs(4)) << "too far away";
  run(described(per_point + ", scale: 0.001}\n"));
  EXPECT_THAT(failures(), IsEmpty());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) EXPECT_EQ(truth().saliency[i], mesh.vertices[i].x());
}

}  // namespace
}  // namespace salbench
