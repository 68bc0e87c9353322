// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/cloud_file.h"

#include <bit>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lzf.h>

#include "stages/core/errors.h"
#include "tests/support/cloud_text.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

const std::vector<Vec3> kPoints = {{0.1, -2, 3e-7}, {1.0 / 3, 0, 5}, {-7, 1e20, 2}};
const std::vector<Vec3> kNormals = {{0, 0, 1}, {0.6, 0, -0.8}, {-1, 0, 0}};

void expect_refusal(std::string_view bytes, const char* path, std::string_view why) {
  EXPECT_THAT([&] { parse_cloud(bytes, path); }, ThrowsMessage<InputError>(HasSubstr(why)));
}

// --- which files are point clouds --------------------------------------------------------------------------

TEST(CloudFile, TellsPointCloudsFromMeshesByExtensionAndHeader) {
  EXPECT_TRUE(is_point_cloud("", "a.xyz"));
  EXPECT_TRUE(is_point_cloud("", "a.PCD"));
  EXPECT_FALSE(is_point_cloud("", "a.off"));
  EXPECT_TRUE(is_point_cloud(ply_cloud_text(kPoints), "a.ply"));
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
  EXPECT_TRUE(is_point_cloud(header + "element face 0\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header + "element face 2\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header + "element tristrips 0\nend_header\n", "a.ply"));
  EXPECT_FALSE(is_point_cloud(header, "a.ply"));  // no end: the reader of meshes says what is wrong
  EXPECT_TRUE(has_shape_extension("b/a.XYZ"));
  EXPECT_TRUE(has_shape_extension("b/a.off"));
  EXPECT_FALSE(has_shape_extension("b.xyz/a"));
}

TEST(CloudFile, SaysWhatIsWrongWithTheFileItself) {
  expect_refusal("", "a.xyz", "a.xyz: the file is empty");
  expect_refusal("1 2 3", "a.txt", "a.txt: is not named as a point cloud: convert it to .ply, .pcd or .xyz");
}

// --- XYZ ---------------------------------------------------------------------------------------------------

TEST(Xyz, ReadsPointsAndNormalsToTheBit) {
  EXPECT_EQ(parse_xyz(xyz_text(kPoints), "a").points, kPoints);
  EXPECT_THAT(parse_xyz(xyz_text(kPoints), "a").normals, IsEmpty());
  const PointCloud cloud = parse_xyz(xyz_text(kPoints, kNormals), "a");
  EXPECT_EQ(cloud.points, kPoints);
  EXPECT_EQ(cloud.normals, kNormals);
  EXPECT_FALSE(cloud.viewpoint);
}

TEST(Xyz, TakesCommentsBlankLinesACountAndGaps) {
  EXPECT_THAT(parse_xyz("# scanner 3\r\n2\r\n\r\n1 2 3 # first\r\n\t4 5 6\r\n", "a").points,
              ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  const PointCloud gap = parse_xyz("nan nan nan\n4 5 inf\n1 2 3\n", "a");
  ASSERT_THAT(gap.points, SizeIs(3));
  EXPECT_FALSE(gap.points[0].allFinite());
  EXPECT_FALSE(gap.points[1].allFinite());
}

TEST(Xyz, NamesTheLineThatIsWrong) {
  expect_refusal("1 2 3\n1 2\n", "a.xyz", "a.xyz:2: a point needs 3 values, x y z, or 6");
  expect_refusal("1 2 3 4\n", "a.xyz", "a.xyz:1: a point needs 3 values");
  expect_refusal("1 2 3 0 0 1 9\n", "a.xyz", "a.xyz:1: a point needs 3 values");
  expect_refusal("1 2 3\n1 2 3 0 0 1\n", "a.xyz",
                 "a.xyz:2: the line has 6 values, and the lines before have 3");
  expect_refusal("1 2 3 0 0 1\n1 2 3\n", "a.xyz",
                 "a.xyz:2: the line has 3 values, and the lines before have 6");
  expect_refusal("1 2 3 255 128 0\n", "a.xyz",
                 "a.xyz:1: the last three of six values are 255 128 0, which is not");
  expect_refusal("C 2 3\n", "a.xyz", "a.xyz:1: \"C\" is not a number");
  expect_refusal("1,2,3\n", "a.xyz", "a.xyz:1: \"1,2,3\" is not a whole number");
  expect_refusal("3\n1 2 3\n1 2 3\n", "a.xyz", "a.xyz:3: the file ends after 2 of 3 points: it is cut short");
  expect_refusal("1\n1 2 3\n1 2 3\n", "a.xyz",
                 "a.xyz:3: there are more points than the 1 that the first line");
  expect_refusal("-1\n", "a.xyz", "a.xyz:1: -1 points: a count cannot be negative");
  expect_refusal("99999999999\n1 2 3\n", "a.xyz", "a.xyz:1: 99999999999 points: at most");
  expect_refusal("# nothing\n\n", "a.xyz", "a.xyz:2: the file ends without a point");
}

// --- PCD ---------------------------------------------------------------------------------------------------

// Out of order, with fields of other types and several values in between.
constexpr const char* kFields =
    "FIELDS rgb z normal_x y _ normal_y x normal_z ring\n"
    "SIZE 4 8 4 8 1 4 8 8 2\n"
    "TYPE F F F F U F F F I\n"
    "COUNT 1 1 1 1 3 1 1 1 2\n";

std::string point_bytes(std::size_t i) {
  std::string bytes;
  append_raw(bytes, std::nanf(""));
  append_raw(bytes, kPoints[i].z());
  append_raw(bytes, static_cast<float>(kNormals[i].x()));
  append_raw(bytes, kPoints[i].y());
  bytes += "pad";
  append_raw(bytes, static_cast<float>(kNormals[i].y()));
  append_raw(bytes, kPoints[i].x());
  append_raw(bytes, kNormals[i].z());
  append_raw(bytes, std::int16_t{-3});
  append_raw(bytes, std::int16_t{4});
  return bytes;
}

// The same values field by field, compressed.
std::string compressed_body() {
  constexpr std::size_t kBytes[] = {4, 8, 4, 8, 3, 4, 8, 8, 4};
  std::string whole;
  std::size_t offset = 0;
  for (const std::size_t bytes : kBytes) {
    for (std::size_t i = 0; i < kPoints.size(); ++i) whole += point_bytes(i).substr(offset, bytes);
    offset += bytes;
  }
  std::string packed(2 * whole.size(), '\0');
  packed.resize(lzf_compress(whole.data(), static_cast<unsigned>(whole.size()), packed.data(),
                             static_cast<unsigned>(packed.size())));
  std::string body;
  append_raw(body, static_cast<std::uint32_t>(packed.size()));
  append_raw(body, static_cast<std::uint32_t>(whole.size()));
  return body + packed;
}

std::string binary_file() {
  std::string file = pcd_header(3, 1, "binary", kFields);
  for (std::size_t i = 0; i < kPoints.size(); ++i) file += point_bytes(i);
  return file;
}

std::string compressed_file() { return pcd_header(3, 1, "binary_compressed", kFields) + compressed_body(); }

TEST(Pcd, ReadsEveryEncodingToTheSameCloud) {
  std::string ascii = pcd_header(3, 1, "ascii", kFields);
  for (std::size_t i = 0; i < 3; ++i)
    ascii += fmt::format("nan {} {} {} 1 2 3 {} {} {} -3 4\n", kPoints[i].z(), kNormals[i].x(),
                         kPoints[i].y(), kNormals[i].y(), kPoints[i].x(), kNormals[i].z());
  EXPECT_EQ(parse_pcd(ascii, "a").normals, kNormals);
  for (const std::string& file :
       {ascii, binary_file(), compressed_file(), compressed_file() + std::string(40, '\0')}) {
    const PointCloud cloud = parse_pcd(file, "a");
    EXPECT_EQ(cloud.points, kPoints);
    ASSERT_THAT(cloud.normals, SizeIs(3));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((cloud.normals[i] - kNormals[i]).norm(), 1e-6);
    EXPECT_FALSE(cloud.viewpoint);
  }
}

TEST(Pcd, ReadsNumbersOfEveryType) {
  const char* fields = "FIELDS x y z\nSIZE {0} {0} {0}\nTYPE {1} {1} {1}\nCOUNT 1 1 1\n";
  const auto read = [&](auto value, char type) {
    std::string file = pcd_header(1, 1, "binary", fmt::format(fmt::runtime(fields), sizeof value, type));
    for (int axis = 0; axis < 3; ++axis) append_raw(file, value);
    return parse_pcd(file, "a").points.at(0);
  };
  EXPECT_EQ(read(std::int8_t{-100}, 'I'), Vec3::Constant(-100));
  EXPECT_EQ(read(std::uint8_t{200}, 'U'), Vec3::Constant(200));
  EXPECT_EQ(read(std::int16_t{-30000}, 'I'), Vec3::Constant(-30000));
  EXPECT_EQ(read(std::uint16_t{60000}, 'U'), Vec3::Constant(60000));
  EXPECT_EQ(read(std::int32_t{-2000000000}, 'I'), Vec3::Constant(-2e9));
  EXPECT_EQ(read(std::uint32_t{4000000000}, 'U'), Vec3::Constant(4e9));
  EXPECT_EQ(read(std::int64_t{-1} << 40, 'I'), Vec3::Constant(-std::exp2(40)));
  EXPECT_EQ(read(std::uint64_t{1} << 63, 'U'), Vec3::Constant(std::exp2(63)));
  EXPECT_EQ(read(0.1F, 'F'), Vec3::Constant(static_cast<double>(0.1F)));
  EXPECT_EQ(read(0.1, 'F'), Vec3::Constant(0.1));
}

TEST(Pcd, KnowsAViewpointThatIsNotTheOriginOrThatOfAnOrganisedCloud) {
  const auto viewpoint = [](std::size_t width, std::size_t height, const char* written) {
    const std::string file =
        pcd_header(width, height, "ascii", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n", written);
    return parse_pcd(file + "1 2 3\nnan nan nan\n", "a").viewpoint;
  };
  EXPECT_FALSE(viewpoint(2, 1, "0 0 0 1 0 0 0"));
  EXPECT_EQ(viewpoint(2, 1, "0 0.5 -1 1 0 0 0"), Vec3(0, 0.5, -1));
  EXPECT_EQ(viewpoint(1, 2, "0 0 0 1 0 0 0"), Vec3(0, 0, 0));
  const std::string old = "COLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n";
  EXPECT_THAT(parse_pcd(old, "a").points, ElementsAre(Vec3(1, 2, 3)));
}

TEST(Pcd, NamesTheLineOfTheHeaderThatIsWrong) {
  const auto refused = [](std::string_view line, std::string_view by, std::string_view why) {
    std::string file = pcd_header(2, 1, "ascii") + "1 2 3\n4 5 6\n";
    file.replace(file.find(line), line.size(), by);
    expect_refusal(file, "a.pcd", why);
  };
  refused("VERSION 0.7", "ply", "a.pcd:2: \"ply\" is not a keyword of a PCD header");
  refused("FIELDS x y z", "FIELDS x y w", "the header has no field \"z\" of one number per point");
  refused("FIELDS x y z\n", "", "a.pcd:3: the line stands before FIELDS");
  refused("SIZE 8 8 8", "SIZE 8 3 8", "a.pcd:4: a value of 3 bytes");
  refused("SIZE 8 8 8", "SIZE 8 8", "a.pcd:4: the line ends where a whole number is expected");
  refused("SIZE 8 8 8", "SIZE 8 8 8 8", "a.pcd:4: the line has more values than the 3 fields");
  refused("SIZE 8 8 8", "SIZE 8 2 8", "field \"y\": floating point of 2 bytes");
  refused("TYPE F F F", "TYPE F D F", "a.pcd:5: \"D\" is not a PCD type: expected I, U or F");
  refused("COUNT 1 1 1", "COUNT 1 -1 1", "a.pcd:6: -1 is not between 0 and 100000");
  refused("COUNT 1 1 1", "COUNT 1 2 1", "the header has no field \"y\" of one number per point");
  refused("WIDTH 2", "WIDTH -2", "a.pcd:7: -2 is not between 0 and 2147483647");
  refused("WIDTH 2", "WIDTH 5", "the header announces 2 points, and 5 x 1");
  refused("HEIGHT 1", "HEIGHT 2147483648", "a.pcd:8: 2147483648 is not between");
  refused("POINTS 2", "POINTS 99999999999999999999", "does not fit 64 bits");
  refused("VIEWPOINT 0 0", "VIEWPOINT 0 nan", "a.pcd:9: \"nan\" is not a finite number");
  refused("DATA ascii", "DATA text",
          "\"text\" is not a PCD format: expected ascii, binary or binary_compressed");
  expect_refusal("VERSION 0.7\nFIELDS x y z\n", "a.pcd", "the file ends within the header");
  expect_refusal(pcd_header(0, 1, "ascii"), "a.pcd", "the header announces no points");
}

TEST(Pcd, SaysHowABodyDoesNotFitItsHeader) {
  const std::string header = pcd_header(2, 1, "ascii");
  expect_refusal(header + "1 2 3\n", "a.pcd", "a.pcd:12: the file ends after 1 of 2 points");
  expect_refusal(header + "1 2 3\n4 5\n", "a.pcd", "the file ends after 1 of 2 points");
  expect_refusal(header + "1 2 3 4\n4 5 6\n", "a.pcd",
                 "a.pcd:12: the line has more values than the header says");
  expect_refusal(header + "1 2 3\n4 5 6\n7 8 9\n", "a.pcd",
                 "a.pcd:14: there is more text after the last point");
  const std::string binary = binary_file();
  expect_refusal(binary.substr(0, binary.size() - 1), "a.pcd", "a.pcd: the file ends after 2 of 3 points");
  expect_refusal(binary + "x", "a.pcd", "a.pcd: there are 1 bytes after the last point");
  // More points than any memory holds, or than a product of counts can say.
  expect_refusal(pcd_header(2147483647, 1, "binary", kFields), "a.pcd",
                 "the file ends after 0 of 2147483647");
  expect_refusal(pcd_header(2147483647, 1, "binary_compressed") + std::string(16, '\1'), "a.pcd", "a.pcd: ");
}

TEST(Pcd, RefusesCompressedBytesThatAreCutOrDamaged) {
  const std::string head = pcd_header(3, 1, "binary_compressed", kFields), file = compressed_file();
  expect_refusal(file.substr(0, head.size() + 5), "a.pcd", "the file ends after 0 of 3 points");
  expect_refusal(file.substr(0, file.size() - 1), "a.pcd", "compressed bytes: it is cut short");
  expect_refusal(file + "x", "a.pcd", "a.pcd: there are 1 bytes after the last point");
  std::string damaged = file;
  damaged[head.size() + 8] = '\xff';  // a copy of bytes that are not there yet
  expect_refusal(damaged, "a.pcd", "the compressed bytes are damaged");
  damaged = file;
  damaged[head.size() + 4] ^= 1;  // the size
  expect_refusal(damaged, "a.pcd", "3 points of 51 bytes are announced, but");
  // 2 GB announced by 12 bytes.
  std::string bomb = pcd_header(89478485, 1, "binary_compressed");
  append_raw(bomb, std::uint32_t{4});
  append_raw(bomb, std::uint32_t{89478485U * 24U});
  expect_refusal(bomb + "abcd", "a.pcd", "4 compressed bytes cannot hold 2147483640");
  // A little more than can be read, by as many bytes as can hold it.
  constexpr std::uint32_t kWhole = 89478486U * 24U, kPacked = kWhole / 88 + 1;
  std::string large = pcd_header(89478486, 1, "binary_compressed");
  append_raw(large, kPacked);
  append_raw(large, kWhole);
  expect_refusal(large + std::string(kPacked, '\0'), "a.pcd",
                 "a.pcd: uncompressed 2147483664 bytes: at most 2147483648 can be read");
}

// --- PLY ---------------------------------------------------------------------------------------------------

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
      std::string raw;
      append_raw(raw, value);
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
    expect_refusal(std::string_view(file).substr(0, file.size() - 1), "a.ply", "a.ply: the file ends after");
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
  expect_refusal(faces, "a.ply", "the header announces faces: the file holds a mesh");
  std::string no_z = text;
  no_z.replace(no_z.find("double z"), 8, "double w");
  expect_refusal(no_z, "a.ply", "the header gives vertices no number \"z\"");
  expect_refusal(text.substr(0, text.rfind(' ')), "a.ply", "the file ends after 2 of 3 vertices");
  expect_refusal(text + "1 2 3\n", "a.ply", "there is more text after the last vertex");
}

}  // namespace
}  // namespace salbench
