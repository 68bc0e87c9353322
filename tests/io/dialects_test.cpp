// SPDX-License-Identifier: GPL-3.0-or-later
// Files as found in practice: one row per input, with the expected outcome. A new case is a row.

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/values_file.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using namespace std::string_literals;

std::string text_of(const Vec3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

std::string parsed_shape(std::string_view bytes, const std::string& file) {
  std::vector<std::string> parts;
  if (is_point_cloud(bytes, file)) {
    const PointCloud cloud = parse_ply_cloud(bytes, file);
    for (const Vec3& point : cloud.points) parts.push_back(text_of(point));
    for (const Vec3& normal : cloud.normals) parts.push_back("n " + text_of(normal));
  } else {
    const Mesh mesh = parse_mesh(bytes, file);
    for (const Vec3& vertex : mesh.vertices) parts.push_back(text_of(vertex));
    for (const Triangle& face : mesh.faces)
      parts.push_back(fmt::format("f {} {} {}", face[0], face[1], face[2]));
  }
  return fmt::format("{}", fmt::join(parts, " | "));
}

// "0 0 0 | 1 0 0 | f 0 1 2", "n 0 0 1" for a normal, the values of .val and .pid; or the message.
std::string outcome(const std::string& file, std::string_view bytes) {
  try {
    const std::string extension = lower_case_extension(file);
    if (extension == ".val")
      return fmt::format("{}", fmt::join(parse_values(bytes, file, {Elements::kUnknown}), " "));
    if (extension == ".pid") return fmt::format("{}", fmt::join(parse_picks(bytes, file, {20}), " "));
    return parsed_shape(bytes, file);
  } catch (const InputError& error) {
    return error.what();
  }
}

struct Row {
  const char* file;
  std::string bytes;
  const char* expected;  // the outcome, or the beginning of a message
};

void expect_outcomes(const std::vector<Row>& rows) {
  for (const Row& row : rows)
    if (std::string_view(row.expected).starts_with(row.file))
      EXPECT_THAT(outcome(row.file, row.bytes), StartsWith(row.expected)) << row.bytes;
    else
      EXPECT_EQ(outcome(row.file, row.bytes), row.expected) << row.bytes;
}

// "ply", the header of points with these properties, and the body; lines end in `end`.
std::string ply(std::string_view format, int points, std::string_view body, std::string_view end = "\n") {
  std::string text;
  for (const std::string& line :
       {"ply"s, fmt::format("format {} 1.0", format), fmt::format("element vertex {}", points),
        "property float x"s, "property float y"s, "property float z"s, "end_header"s})
    text += line + std::string(end);
  return text + std::string(body);
}

std::string floats(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

constexpr const char* kTriangle = "0 0 0 | 1 0 0 | 0 1 0 | f 0 1 2";

TEST(Dialects, ACommentBeginsAWord) {
  expect_outcomes({
      {"a.off", "OFF\n3 1 0\n0 0 0 # a\n1 0 0\t#b\n#c\n0 1 0\n3 0 1 2 #d\n", kTriangle},
      {"a.off", "OFF\n3 1 0\n0 0 1.#INF\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off:3: \"1.#INF\""},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2#d\n", "a.off:6: \"2#d\""},
      {"a.obj", "v 0 0 -1.#IND\n", "a.obj:1: \"-1.#IND\""},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3#4\n", "a.obj:4: \"3#4\""},
      {"a.obj", "v 0 0 0 # a\nv 1 0 0\nv 0 1 0\nf 1 2 3 # b\n", kTriangle},
      {"a.ply", ply("ascii", 1, "0 1.#QNAN 0\n"), "a.ply:8: \"1.#QNAN\""},
      {"a.pid", "12#3\n", "a.pid:1: \"12#3\""},
      {"a.pid", "12 # 3\n#4\n5\n", "12 5"},
      {"a.val", "info\n0.5\n", "0.5"},
      {"a.val", "nan\n0.5\n", "a.val:1: \"nan\""},
      {"a.val", ".5x\n0.5\n", "a.val:1: \".5x\""},
  });
}

TEST(Dialects, EachLineEndsInItsOwnWay) {
  const std::string lf_floats = "\n\n\n\n"s + floats({1, 2}), cr_floats = "\r\n\r\n"s + floats({1, 2});
  expect_outcomes({
      {"a.off", "OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\n", kTriangle},    // CR, and one LF at the end
      {"a.off", "OFF\r\n3 1 0\r0 0 0\n1 0 0\r\n0 1 0\r3 0 1 2", kTriangle},  // all three
      {"a.off", "OFF\n\r3 1 0\n\r0 0 0\n\r1 0 0\n\r0 1 x\n\r3 0 1 2", "a.off:9: \"x\""},
      {"a.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\n", kTriangle},
      {"a.obj", "v 0 0 0 \\\r\nv 1 0 0\n", "0 0 0"},
      {"a.val", "1\r2\r3\n", "1 2 3"},
      {"a.val", "1\r2\r\nx\n", "a.val:3: \"x\""},
      {"a.pid", "1\r2\n3\r\n4", "1 2 3 4"},
      {"a.ply", ply("ascii", 2, "0 0 0\r1 2 3\n", "\r"), "0 0 0 | 1 2 3"},
      {"a.ply", ply("ascii", 2, "0 0 0\n1 2 3\r", "\r\n"), "0 0 0 | 1 2 3"},
      {"a.ply", ply("binary_little_endian", 1, floats({1, 2, 3}), "\r"), "1 2 3"},
      {"a.ply", ply("binary_little_endian", 1, floats({1, 2, 3}), "\r\n"), "1 2 3"},
      // Bodies that begin with a possible line end.
      {"a.ply", ply("binary_little_endian", 1, lf_floats, "\r"), "6.646346445936972e-33 1 2"},
      {"a.ply", ply("binary_little_endian", 1, lf_floats, "\n"), "6.646346445936972e-33 1 2"},
      {"a.ply", ply("binary_little_endian", 1, cr_floats, "\n"), "6.790793395817922e-33 1 2"},
      {"a.ply", ply("binary_little_endian", 1, cr_floats, "\r\n"), "6.790793395817922e-33 1 2"},
      {"a.ply", ply("binary_little_endian", 1, cr_floats, "\r"), "6.790793395817922e-33 1 2"},
      // A header with mixed line ends would lose a line.
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\rproperty float x\nend_header\n",
       "a.ply:3: \"property\""},
      {"a.ply", "ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty uchar a\rproperty float x\r\n",
       "a.ply:4: \"property\""},
  });
}

std::string ply_mesh(std::string_view body, std::string_view more = "", int faces = 1) {
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{}"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n{}",
      more, faces, body);
}

TEST(Dialects, ARecordMaySpanLinesWhereTheHeaderFixesTheCount) {
  const char* const kColours = "property uchar r\nproperty uchar g\nproperty uchar b\n";
  expect_outcomes({
      // PLY: a vertex over two lines, everything on one line, a number per line.
      {"a.ply", ply_mesh("0 0 0\n9 9 9\n1 0 0\n9 9 9\n0 1 0\n9 9 9\n3 0 1 2\n", kColours), kTriangle},
      {"a.ply", ply_mesh("0 0 0 1 0 0 0 1 0 3 0 1 2\n"), kTriangle},
      {"a.ply", ply_mesh("0\n0\n0\n\n1\n0\n0\n0\n1\n0\n3\n0\n1\n2\n"), kTriangle},
      {"a.ply", ply_mesh("0 0 0 1 0 0\n0 1 0\n3 0 1 2 3 2 1 0\n", "", 2),
       "0 0 0 | 1 0 0 | 0 1 0 | f 0 1 2 | f 2 1 0"},
      // A missing or extra value is reported with its line.
      {"a.ply", ply_mesh("0 0 0\n1 0 0\n0 1 0 3\n3 0 1 2\n"), "a.ply:12:"},
      {"a.ply", ply_mesh("0 0 0\n1 0 0 1 0 0\n0 1 0\n3 0 1 2\n"), "a.ply:11:"},
      {"a.ply", ply_mesh("0 0 0\n1 0 0\n0 1 0\n3 0 1\n3 0 1 2\n", "", 2), "a.ply:14:"},
      {"a.ply", ply_mesh("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n7\n"), "a.ply:14:"},
      {"a.ply", ply("ascii", 3, "0 0 0\n1 0\n2 0 0 5\n"), "a.ply:9:"},
      {"a.ply", ply("ascii", 3, "0 0 0 5\n1 0\n2 0 0\n"), "a.ply:8:"},
      // OFF: counts and records over lines; several on one; further columns end with the line.
      {"a.off", "OFF\n3\n1\n3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", kTriangle},
      {"a.off", "OFF\n3\n1 3\n0 0\n0\n1 0\n0\n0 1\n0\n3\n0 1 2\n", kTriangle},
      {"a.off", "OFF 3 1 3 0 0 0 1 0 0 0 1 0 3 0 1 2\n", kTriangle},
      {"a.off", "OFF\n3 1 3\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n", kTriangle},
      {"a.off", "OFF\n4 2 0\n0 0 0 1 0 0\n0 1 0 1 1 0\n3 0 1 2 3 2 1 3\n",
       "0 0 0 | 1 0 0 | 0 1 0 | 1 1 0 | f 0 1 2 | f 2 1 3"},
      {"a.off", "OFF\n3 1 0\n0 0 0 .1 .2 .3\n1 0 0 .1 .2 .3\n0 1 0 .1 .2 .3\n3 0 1 2 9 9 9\n", kTriangle},
      {"a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n3 2 1 0\n", "a.off:7:"},
      {"a.off", "OFF\n3 1 0\n0 0 0 1\n0 0 0 1\n0\n3 0 1 2\n", "a.off:5:"},
  });
}

// One walk reads the records of PLY and OFF: what each of them takes, and the others do not.
TEST(Dialects, FormatsOfRecordsKeepTheirOwnWays) {
  const std::string mesh = "0 0 0\n1 0 0\n0 1 0\n", zeros(4, '\0');
  expect_outcomes({
      {"a.ply", ply_mesh(mesh + "3.0 0 1.0 2\n"), kTriangle},
      {"a.off", "OFF\n3 1 0\n" + mesh + "3.0 0 1 2\n", "a.off:6: \"3.0\""},
      {"a.off", "OFF\n3 1 0\n" + mesh + "3 0 1.0 2\n", "a.off:6: \"1.0\""},
      {"a.off", "OFF\n3 1 0\n" + mesh + "3 0 1 2 red\n", kTriangle},
      {"a.ply", ply_mesh(mesh + "3 0 1 2 red\n"), "a.ply:13:"},
      {"a.ply", ply("binary_little_endian", 1, floats({1, 2, 3}) + zeros), "a.ply:"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1\nnan\n0\n0 1 0\n3 0 1 2\n", "a.off:5: \"nan\""},
      {"a.ply", ply_mesh("0\nnan 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "a.ply:11: \"nan\""},
  });
}

TEST(Dialects, ABackslashContinuesCoordinatesAndCornersOfObj) {
  expect_outcomes({
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl mats\\wood\\\nf 1 2 3\n", kTriangle},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\\\nf 1 2 3\n", kTriangle},
      {"a.obj", "mtllib C:\\maps\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", kTriangle},
      {"a.obj", "v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\nf 1 \\\n 2 \\\n 3\n", kTriangle},
      {"a.obj", "# a \\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\\n", kTriangle},
  });
}

}  // namespace
}  // namespace salbench
