// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/one_form.h"

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5/one_form_index.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

std::string text_of_image(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ShapeInForm toy_shape() {
  ShapeInForm shape{.mesh = shapes::tetrahedron(), .polygons = {.split = 3, .concave = 1}};
  GroundTruth truth;
  truth.saliency = {1.5, kNan, 3, 0.1};
  truth.viewers = {{1, 2, 3, 4}, {2, kNan, 3, -1}};
  truth.picks = {{3, 1}, {}, {0}};
  shape.truths.push_back({.truth = truth});
  shape.truths.push_back(
      {.view = "300",
       .truth = {.saliency = {1, 2, kNan, kNan}, .picks = {}, .viewers = {{1, 2, kNan, 3}, {4, 5, 6, kNan}}},
       .face_values = {0.5, kNan, 2, 3}});
  shape.about = {{"item", "a"}, {"licence", ""}};
  return shape;
}

std::string error_of(const std::string& image) {
  try {
    return shape_in_form(image, "a.h5") ? "no error" : "nothing of ours";
  } catch (const InputError& error) {
    return error.what();
  }
}

bool same_values(const ScalarField& a, const ScalarField& b) {
  return std::ranges::equal(a, b,
                            [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

TEST(OneForm, HasAMeshAndItsGroundTruthAsTheyWere) {
  const ShapeInForm shape = toy_shape();
  const std::string image = text_of_image(one_form_image(shape));
  const auto found = shape_in_form(image, "a.h5");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->mesh.vertices, shape.mesh.vertices);
  EXPECT_EQ(found->mesh.faces, shape.mesh.faces);
  EXPECT_EQ(found->polygons.split, 3);
  EXPECT_EQ(found->polygons.concave, 1);
  EXPECT_EQ(found->about, shape.about);
  ASSERT_EQ(found->truths.size(), 2U);
  for (const std::size_t k : {0U, 1U}) {
    const TruthInForm &truth = found->truths[k], &expected = shape.truths[k];
    EXPECT_EQ(truth.view, expected.view);
    EXPECT_TRUE(same_values(truth.truth.saliency, expected.truth.saliency));
    EXPECT_EQ(truth.truth.picks, expected.truth.picks);
    EXPECT_TRUE(same_values(truth.face_values, expected.face_values));
    ASSERT_EQ(truth.truth.viewers.size(), expected.truth.viewers.size());
    for (std::size_t v = 0; v < truth.truth.viewers.size(); ++v)
      EXPECT_TRUE(same_values(truth.truth.viewers[v], expected.truth.viewers[v]));
  }
  EXPECT_EQ(text_of_image(one_form_image(toy_shape())), image) << "equal shapes, equal bytes";
}

TEST(OneForm, HasACloudAsItWas) {
  PointCloud cloud{.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 2}},
                   .normals = Normals(3, Vec3::UnitX()),
                   .viewpoint = Vec3(1, 2, 3),
                   .dropped = {1, 4}};
  const std::string image = text_of_image(one_form_image({.is_cloud = true, .cloud = cloud}));
  const auto read = shape_in_form(image, "c.h5");
  ASSERT_TRUE(read && read->is_cloud);
  const PointCloud& found = read->cloud;
  EXPECT_EQ(found.points, cloud.points);
  EXPECT_EQ(found.normals, cloud.normals);
  EXPECT_EQ(found.viewpoint, cloud.viewpoint);
  EXPECT_EQ(found.dropped, cloud.dropped);
  cloud.dropped = {4, 1};
  EXPECT_THAT(error_of(text_of_image(one_form_image({.is_cloud = true, .cloud = cloud}))),
              HasSubstr("the numbers do not ascend"));
}

TEST(OneForm, RefusesWhatRefersToPointsThatThereAreNot) {
  ShapeInForm shape = toy_shape();
  shape.mesh.faces[2][1] = 4;
  EXPECT_THAT(error_of(text_of_image(one_form_image(shape))),
              HasSubstr("data set \"shape/faces\": 4 is out of range: there are 4 points, numbered from 0"));
  shape = toy_shape();
  shape.truths[0].truth.picks[0][0] = -1;
  EXPECT_THAT(error_of(text_of_image(one_form_image(shape))),
              HasSubstr("\"truth/picks\": -1 is out of range"));
  const auto other = shape_in_form(text_of_image(one_form_image(shape)), "a.h5", "300");
  ASSERT_TRUE(other);
  ASSERT_EQ(other->truths.size(), 1U);
  EXPECT_TRUE(same_values(other->truths[0].truth.saliency, {1, 2, kNan, kNan}));
}

TEST(OneFormIndex, HasAnItemPerRowWithTheRemarkOnAll) {
  const std::string header = "item,view,class,split,kind,truth,participants,viewers,source";
  const std::string view = "\"a, b\",300,cups,test,mesh,no,0,0,own", cloud = "c,,,,cloud,yes,3,2,own";
  const TemporaryFolder folder;
  folder.write("index.csv", fmt::format("{}\n{}\n{}\n", header, view, cloud));
  const Dataset plain = indexed_dataset(folder.path());
  ASSERT_EQ(plain.items.size(), 2U);
  EXPECT_EQ(plain.remark, "");
  EXPECT_EQ(plain.items[0].name, "a, b_300");
  EXPECT_EQ(plain.items[0].shape_name(), "a, b");
  EXPECT_EQ(plain.items[0].file, folder / "items/a, b.h5");
  EXPECT_TRUE(plain.items[1].is_cloud && plain.items[1].with_truth);
  EXPECT_EQ(plain.items[1].participants, 3U);
  EXPECT_EQ(plain.items[1].viewers, 2U);
  EXPECT_EQ(plain.items[1].file, folder / "items/c.h5");

  const std::string remark = "\"TRUTH: raw gaze, \"\"as it is\"\"; a || b\"";
  folder.write("index.csv", fmt::format("{0},remarks\n{1},{3}\n{2},{3}\n", header, view, cloud, remark));
  EXPECT_EQ(indexed_dataset(folder.path()).remark, "TRUTH: raw gaze, \"as it is\"; a | b");
  folder.write("index.csv", fmt::format("# TRUTH: raw gaze\n{}\n{}\n", header, cloud));
  EXPECT_EQ(indexed_dataset(folder.path()).remark, "TRUTH: raw gaze");
}

}  // namespace
}  // namespace salbench
