// SPDX-License-Identifier: GPL-3.0-or-later
// The errors where a file of a data set does not fit its description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/mat.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::StartsWith;
using testing::ThrowsMessage;

class BadData : public DataSets {
 protected:
  BadData() {
    data_.write("off/cat.off", off_text(shapes::tetrahedron()));
    data_.write("off/dog.off", off_text(shapes::tetrahedron()));
    data_.write("maps/dog.csv", "1\n2\n3\n4\n");
  }
  std::string place(const std::string& name) const { return (data_ / name).string(); }
};

constexpr const char* kMaps = "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n";

TEST_F(BadData, AGlobThatFitsNothingIsNamedWithItsLine) {
  const std::string own =
      description("# own\nplaces:\n  - meshes: of/*.off\n    truth:\n      saliency: maps/{item}.csv\n");
  EXPECT_THAT([&] { run(own); },
              ThrowsMessage<InputError>(fmt::format(
                  "{}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; "
                  "looked in own: {} ({}:3)",
                  data_.path().string(), place("of/*.off"), own)));
  const std::string other =
      description("places:\n  - meshes: off/*.off\n    truth:\n      saliency: maps/{item}.val\n");
  EXPECT_THAT([&] { run(other); },
              ThrowsMessage<InputError>(
                  fmt::format("{}:4: 'maps/{{item}}.val' fits no file of an item; expected are such as {}",
                              other, place("maps/{item}.val"))));
  const std::string absent = description(
      "places:\n  - meshes: off/*.off\n    truth:\n      picks: clicks/{item}_{participant}.pid\n");
  EXPECT_THAT([&] { run(absent); }, ThrowsMessage<InputError>(StartsWith(absent + ":4: 'clicks/")));
}

TEST_F(BadData, AWrongCountFailsItsItemAlone) {
  data_.write("maps/cat.csv", "1\n2\n3\n");
  run(description(kMaps));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.csv") + ":3: the file has 3 values, but the mesh has 4 vertices"));
  EXPECT_THAT(truth(1).saliency, ElementsAre(1, 2, 3, 4));
  data_.write("maps/cat.csv", "1\n2\n3\n");
  data_.write("maps/dog.csv", "1\n2\n3\n4\n5\n");
  run(description(std::string(kMaps) + "values: {per: face}\n"));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.csv") + ":3: the file has 3 values, but the mesh has 4 faces",
                          place("maps/dog.csv") + ":5: the file has 5 values, but the mesh has 4 faces"));
}

TEST_F(BadData, AWrongColumnIsNamedWithThoseThatThereAre) {
  data_.write("maps/cat.csv", "id,density\n0,1\n1,2\n2,3\n3,4\n");
  data_.write("maps/dog.csv", "0;1\n1;2\n2;3\n3\n");
  run(description(std::string(kMaps) + "values: {column: saliency}\n"));
  EXPECT_THAT(
      failures(),
      ElementsAre(place("maps/cat.csv") + ":1: no column \"saliency\": the header has \"id\", \"density\"",
                  place("maps/dog.csv") +
                      ":1: no column \"saliency\": the first line has numbers, not names of columns"));
  run(description(std::string(kMaps) + "values: {column: 2}\n"));
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/dog.csv") + ":4: the line has 1 column, expected column 2"));
}

TEST_F(BadData, AWrongBaseIsNamed) {
  data_.write("clicks/cat_0.pid", "4\n1\n");
  data_.write("clicks/dog_0.pid", "1\n0\n");
  const std::string clicks =
      "places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n";
  run(description(clicks));
  EXPECT_THAT(failures(),
              ElementsAre(place("clicks/cat_0.pid") +
                          ":1: vertex 4 is out of range: the mesh has 4 vertices, numbered from 0"));
  run(description(clicks + "indices: {base: 1}\n"));
  EXPECT_THAT(truth(0).picks, ElementsAre(ElementsAre(3, 0)));
  EXPECT_THAT(failures(),
              ElementsAre(place("clicks/dog_0.pid") +
                          ":2: vertex 0 is out of range: the mesh has 4 vertices, numbered from 1"));
}

TEST_F(BadData, PicksOfAMatFileAreVerticesToo) {
  data_.write("maps/readme.txt", "");
  MatWriter(data_ / "maps/cat.mat").write("points", {1, 2.5});
  MatWriter(data_ / "maps/dog.mat").write("points", {4, 0});
  const std::string mats = "places: [{meshes: 'off/*', truth: {picks: 'maps/{item}.mat'}}]\n";
  run(description(mats + "indices: {base: 1, variable: points}\n"));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.mat") +
                              ": points: pick 2 (from 1) is 2.5: the mesh has 4 vertices, numbered from 1",
                          place("maps/dog.mat") +
                              ": points: pick 2 (from 1) is 0: the mesh has 4 vertices, numbered from 1"));
  run(description(mats));
  EXPECT_THAT(failures(), Each(HasSubstr("the description names no `variable:` in it")));
}

TEST_F(BadData, TwoFilesWhereOneIsMeantAreNamed) {
  data_.write("more_maps/dog.csv", "1\n2\n3\n4\n");
  EXPECT_THAT(
      [&] { run(description("places: [{meshes: 'off/*', truth: {saliency: '*maps/{item}.csv'}}]\n")); },
      ThrowsMessage<InputError>(AllOf(StartsWith(place("more_maps/dog.csv") + ": dog has a file already, "),
                                      HasSubstr("own.yaml:1 means one: keep one of them"))));
}

TEST_F(BadData, PointsFarFromTheMeshAreNoValues) {
  data_.write("maps/cat.csv", "x,y,z,s\n100,100,100,1\n");
  data_.write("maps/dog.csv", "x,y,z,s\n");
  run(description(std::string(kMaps) + "values: {per: point, points: [x, y, z], column: s}\n"));
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("cat.csv: no point of the shape has a value; expected are"),
                                      HasSubstr("dog.csv:1: the file has no values")));
}

TEST_F(BadData, APointWhoseSquareOverflowsFailsItsItemAlone) {
  data_.write("maps/cat.csv", "x,y,z,s\n1,1,1,1\n1e300,0,0,2\n");
  data_.write("maps/dog.csv", "x,y,z,s\n1,1,1,5\n");
  run(description(std::string(kMaps) +
                  "values: {per: point, points: [x, y, z], column: s, max_distance: 100}\n"));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.csv") + ":3: a coordinate is larger than 1e150: scale the mesh"));
  EXPECT_THAT(truth(1).saliency, ElementsAre(5, 5, 5, 5));
}

TEST_F(BadData, AParticipantWithoutPicksCountsAndNobodysPicksAreAnError) {
  data_.write("clicks/cat_0.pid", "3\n");
  data_.write("clicks/cat_1.pid", "");
  data_.write("clicks/dog_0.pid", "");
  data_.write("clicks/dog_1.pid", "");
  run(description("places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n"));
  EXPECT_THAT(truth(0).picks, ElementsAre(ElementsAre(3), IsEmpty()));
  EXPECT_THAT(failures(),
              ElementsAre(HasSubstr("dog_0.pid: nobody picked a point and there is no saliency file; "
                                    "remove the empty .pid files")));
}

TEST_F(BadData, NumpyFilesAreReadToo) {
  std::string npy = std::string("\x93NUMPY\x01\x00", 8) + std::string("\x46\x00", 2) +
                    "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }           \n";
  npy.resize(10 + 0x46, ' ');
  for (const double value : {1.0, -1.0, 3.0, 4.0})
    npy.append(reinterpret_cast<const char*>(&value), sizeof value);
  data_.write("maps/cat.csv", npy);
  run(description(std::string(kMaps) + "values: {unseen: -1}\n"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, IsNan(), 3, 4));
  run(description(std::string(kMaps) + "values: {per: point, points: [x, y, z], column: s}\n"));
  EXPECT_THAT(failures(), Contains(HasSubstr("cat.csv: values per point stand in columns beside x, y and z: "
                                             "write them as text")));
}

}  // namespace
}  // namespace salbench
