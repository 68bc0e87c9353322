// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/cloud_file.h"

#include <bit>

#include "tests/support/cloud_text.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::vector<Vec3> kPoints = {{0.1, -2, 3e-7}, {1.0 / 3, 0, 5}, {-7, 1e20, 2}};
const std::vector<Vec3> kNormals = {{0, 0, 1}, {0.6, 0, -0.8}, {-1, 0, 0}};

void expect_refusal(std::string_view bytes, std::string_view why) {
  EXPECT_THAT([&] { parse_ply_cloud(bytes, "a.ply"); }, Refuses(why));
}

TEST(CloudFile, TellsPointCloudsFromMeshesByExtensionAndHeader) {
  EXPECT_TRUE(is_point_cloud("", "a.xyz"));
  EXPECT_TRUE(is_point_cloud("", "a.PCD"));
  EXPECT_FALSE(is_point_cloud("", "a.off"));
  EXPECT_TRUE(is_point_cloud(ply_cloud_text(kPoints), "a.ply"));
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
  EXPECT_TRUE(is_point_cloud(header + "element face 0\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header + "element face 2\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header + "element tristrips 0\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header, "a.ply"));  // unterminated: the reader of meshes reports the problem
  EXPECT_TRUE(has_shape_extension("b/a.XYZ"));
  EXPECT_TRUE(has_shape_extension("b/a.off"));
  EXPECT_FALSE(has_shape_extension("b.xyz/a"));
}

TEST(PlyCloud, ReadsPointsAndNormalsToTheBit) {
  const PointCloud cloud = parse_ply_cloud(ply_cloud_text(kPoints, kNormals), "a");
  EXPECT_EQ(cloud.points, kPoints);
  EXPECT_EQ(cloud.normals, kNormals);
  EXPECT_FALSE(cloud.viewpoint);
  EXPECT_THAT(parse_ply_cloud(ply_cloud_text(kPoints), "a").normals, IsEmpty());
}

TEST(PlyCloud, ReadsBothByteOrdersWithGapsColoursAndACamera) {
  for (const bool big_endian : {false, true}) {
    std::string file = fmt::format(
        "ply\nformat binary_{}_endian 1.0\nelement vertex 2\nproperty float x\nproperty uchar red\n"
        "property float y\nproperty float nz\nproperty float z\nproperty float nx\nproperty float ny\n"
        "element camera 1\nproperty float view_px\nproperty float view_py\nproperty float view_pz\n"
        "property int viewportx\nproperty int viewporty\nend_header\n",
        big_endian ? "big" : "little");
    const auto add = [&](auto value) {
      const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
      const std::string raw(bytes.begin(), bytes.end());
      file += big_endian ? std::string(raw.rbegin(), raw.rend()) : raw;
    };
    for (const float x : {1.5F, std::nanf("")}) {
      add(x);
      add(std::uint8_t{7});
      for (const float value : {2.0F, 0.8F, 3.0F, 0.6F, 0.0F}) add(value);
    }
    for (const float position : {0.0F, -4.0F, 1.0F}) add(position);
    for (const std::int32_t size : {2, 1}) add(size);
    const PointCloud cloud = parse_ply_cloud(file, "a");
    ASSERT_THAT(cloud.points, SizeIs(2));
    EXPECT_EQ(cloud.points[0], Vec3(1.5, 2, 3));
    EXPECT_TRUE(std::isnan(cloud.points[1].x()));
    EXPECT_LT((cloud.normals.at(0) - Vec3(0.6, 0, 0.8)).norm(), 1e-6);
    EXPECT_EQ(cloud.viewpoint, Vec3(0, -4, 1));
    expect_refusal(std::string_view(file).substr(0, file.size() - 1), "a.ply:");
  }
}

TEST(PlyCloud, KnowsTheOriginAsViewpointOfOrganisedCloudsOnly) {
  const auto viewpoint = [](int rows) {
    return parse_ply_cloud(
               fmt::format("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                           "property float z\nelement camera 1\nproperty float view_px\n"
                           "property float view_py\nproperty float view_pz\nproperty int viewporty\n"
                           "end_header\n1 2 3\n0 0 0 {}\n",
                           rows),
               "a")
        .viewpoint;
  };
  EXPECT_FALSE(viewpoint(1));
  EXPECT_EQ(viewpoint(480), Vec3(0, 0, 0));
}

TEST(PlyCloud, RefusesMeshesAndFilesWithoutPositions) {
  const std::string text = ply_cloud_text(kPoints);
  std::string faces = text;
  faces.replace(faces.find("end_header"), 0, "element face 1\nproperty list uchar int vertex_indices\n");
  expect_refusal(faces, "the header announces faces: the file holds a mesh");
  std::string no_z = text;
  no_z.replace(no_z.find("double z"), 8, "double w");
  expect_refusal(no_z, "the header gives vertices no number \"z\"");
  expect_refusal(text.substr(0, text.rfind(' ')), "the file ends after 2 of 3 vertices");
  expect_refusal(text + "1 2 3\n", "there is more text after the last vertex");
}

}  // namespace
}  // namespace salbench
