// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>

#include "io/shapes/mesh_file.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Builds the body of a binary file, value by value.
struct Bytes {
  bool big_endian = false;
  std::string bytes;

  template <class T>
  Bytes& add(T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
    return *this;
  }
};

// Types of every width, properties out of order, irrelevant lists and elements.
constexpr std::string_view kElements =
    "comment made for a test\n"
    "element camera 1\n"
    "property list uchar short view\n"
    "property double focus\n"
    "element vertex 4\n"
    "property uchar red\n"
    "property double y\n"
    "property float x\n"
    "property list ushort float weights\n"
    "property short z\n"
    "element face 2\n"
    "property char flag\n"
    "property list uchar uint vertex_indices\n"
    "property list int8 double texcoord\n"
    "obj_info nothing\n"
    "element edge 1\n"
    "property int32 vertex1\n"
    "end_header\n";

std::string binary_file(bool big_endian) {
  Bytes body{big_endian, {}};
  body.add<std::uint8_t>(2).add<std::int16_t>(-1).add<std::int16_t>(300).add(1.5);
  const double y[] = {0, 0, 1.0 / 3, 1};
  const float x[] = {-0.5F, 1, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    body.add<std::uint8_t>(255).add(y[i]).add(x[i]).add(static_cast<std::uint16_t>(i));
    for (std::size_t weight = 0; weight < i; ++weight) body.add(std::numeric_limits<float>::quiet_NaN());
    body.add(static_cast<std::int16_t>(-7 * static_cast<int>(i)));
  }
  body.add<std::int8_t>(-1).add<std::uint8_t>(3);
  body.add<std::uint32_t>(0).add<std::uint32_t>(1).add<std::uint32_t>(2).add<std::int8_t>(1).add(0.25);
  body.add<std::int8_t>(-1).add<std::uint8_t>(4);
  for (const std::uint32_t corner : {3U, 2U, 1U, 0U}) body.add(corner);
  body.add<std::int8_t>(0).add<std::int32_t>(10);
  return std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian 1.0\n" +
         std::string(kElements) + body.bytes;
}

std::string ascii_file() {
  return "ply\nformat ascii 1.0\n" + std::string(kElements) +
         "2 -1 300 1.5\n"
         "255 0 -0.5 0 0\n"
         "255 0 1 1 nan -7\n"
         "255 0.3333333333333333 1 2 nan nan -14\n"
         "255 1 0 3 nan nan nan -21\n"
         "-1 3 0 1 2 1 0.25\n"
         "-1 4 3 2 1 0 0\n"
         "10\n";
}

void expect_the_mesh(const Mesh& mesh) {
  EXPECT_THAT(mesh.vertices,
              ElementsAre(Vec3(-0.5, 0, 0), Vec3(1, 0, -7), Vec3(1, 1.0 / 3, -14), Vec3(0, 1, -21)));
  EXPECT_THAT(mesh.faces, ElementsAre(Triangle{0, 1, 2}, Triangle{3, 2, 1}, Triangle{3, 1, 0}));
}

void expect_refusal(std::string_view bytes, std::string_view why) {
  EXPECT_THAT([&] { parse_ply(bytes, "x.ply"); }, Refuses(why)) << bytes;
}

// A text file of three vertices and one triangle, with one piece of it replaced.
std::string triangle_with(std::string_view from, std::string_view to) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  return text.replace(text.find(from), from.size(), to);
}

TEST(Ply, ReadsTheSameFromEveryEncoding) {
  expect_the_mesh(parse_ply(ascii_file(), "x.ply"));
  expect_the_mesh(parse_ply(binary_file(false), "x.ply"));
  expect_the_mesh(parse_ply(binary_file(true), "x.ply"));
  expect_the_mesh(parse_ply(binary_file(true) + "\n", "x.ply"));
}

TEST(Ply, RefusesHeadersThatCannotBe) {
  for (const auto& [from, to, named] : std::vector<std::array<std::string_view, 3>>{
           {"ascii", "binary", "x.ply:2: \"binary\""},
           {"float y", "half y", "x.ply:5: \"half\""},
           {"float y", "float", "x.ply:5: "},
           {"float y", "float t", "no number \"y\""},
           {"float y", "list uchar float y", "no number \"y\""},
           {"element vertex 3", "element point 3", "no element \"vertex\""},
           {"element vertex 3", "element vertex -3", "x.ply:3: -3"},
           {"element vertex 3", "element vertex many", "x.ply:3: \"many\""},
           {"element vertex 3\n", "", "x.ply:3: "},
           {"vertex_index", "corners", "no list \"vertex_indices\""},
           {"list uchar int vertex_index", "int vertex_index", "no list \"vertex_indices\""},
           {"element face 1", "elements face 1", "\"elements\""},
           {"element face 1", "element tristrips 1", "x.ply:"},
           {"format ascii 1.0\n", "", "x.ply:"}})
    expect_refusal(triangle_with(from, to), named);
  for (const char* file : {"", "PLY2\n", "ply\nformat ascii 1.0\n"}) expect_refusal(file, "x.ply:");
}

TEST(Ply, NamesFileAndLineOfWhatIsWrongInText) {
  for (const char* vertex : {"1 0", "1 0 0 0", "1 o 0", "1 nan 0"})
    expect_refusal(triangle_with("1 0 0", vertex), "x.ply:11: ");
  for (const char* face : {"3 0 1 3", "3 0 -1 2", "3 0 0.5 2", "2 0 1", "-3 0 1 2", "1e300 0 1 2", "3 0 1"})
    expect_refusal(triangle_with("3 0 1 2", face), "x.ply:13: ");
  expect_refusal(triangle_with("3 0 1 2", "3 0 1 2\n3 0 1 2"), "x.ply:14: ");
}

TEST(Ply, NamesElementAndByteOfWhatIsWrongInBinary) {
  const std::string file = binary_file(false);
  const auto with = [&](std::size_t from_end, auto value) {
    std::string changed = file;
    changed.replace(file.size() - from_end, sizeof(value), Bytes{}.add(value).bytes);
    return changed;
  };
  const std::size_t last_corner = 4 + 1 + 4;  // preceded by the edge and an empty list
  expect_refusal(with(last_corner, std::uint32_t{4}),
                 "x.ply: face 2 (counted from 1), before byte " + std::to_string(file.size() - 5));
  expect_refusal(with(last_corner + 13, std::uint8_t{2}), "a face with 2 vertices");
  expect_refusal(with(5, std::int8_t{-1}), "-1 is not the length of a list");
  const std::size_t first_y = file.find("end_header\n") + 11 + 13 + 1;
  expect_refusal(with(file.size() - first_y, std::nan("")), "x.ply: vertex 1 (counted from 1)");
  expect_refusal(with(file.size() - first_y, HUGE_VAL), "a coordinate is not a finite number");
  expect_refusal(file + "more", "there are 4 bytes after the last element");
}

TEST(Ply, QuotesTheNameOfAnElementThatItDoesNotKnow) {
  expect_refusal(
      "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty char x\nproperty char y\n"
      "property char z\nelement a\ab 1\nproperty list char char s\nend_header\n\xff",
      "x.ply: element \"a?b\" 1 (counted from 1), before byte 153");
}

TEST(Ply, AbsurdCountsNeedNeitherMemoryNorTime) {
  expect_refusal(triangle_with("vertex 3", "vertex 1000000000000"),
                 "1000000000000 vertices: at most 2147483647");
  expect_refusal(triangle_with("vertex 3", "vertex 2147483647"), "x.ply:13:");
  expect_refusal(triangle_with("face 1", "face 2147483647"), "the file ends after 1 of 2147483647 faces");
  expect_refusal(triangle_with("3 0 1 2", "4294967295 0 1 2"), "the file ends after 0 of 1 faces");
  const std::string bulky = "element void 1000000000000\nelement face 1\n";
  EXPECT_EQ(parse_ply(triangle_with("element face 1\n", bulky), "x.ply").faces.size(), 1U);
  const std::string lists = "element strip 1000000000000\nproperty list uint double s\nend_header\n";
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
      "property float z\n" +
      lists;
  expect_refusal(binary + "\xff\xff\xff\xff----",
                 "the file ends after 0 of 1000000000000 elements \"strip\"");
  expect_refusal(binary + std::string(400, '\0'),
                 "the file ends after 100 of 1000000000000 elements \"strip\"");
}

TEST(Ply, CutShortAtAnyLengthIsRefused) {
  for (const std::string& file : {binary_file(false), binary_file(true)})
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_THROW(parse_ply(std::string_view(file).substr(0, length), "x.ply"), InputError) << length;
  const std::string text = ascii_file();
  for (std::size_t length = 0; length + 2 < text.size(); ++length)  // "1" of "10" is complete
    EXPECT_THROW(parse_ply(std::string_view(text).substr(0, length), "x.ply"), InputError) << length;
}

}  // namespace
}  // namespace salbench
