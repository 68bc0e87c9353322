// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr const char* kTetrahedron =
    "OFF\n"
    "4 4 6\n"
    "1 1 1\n"
    "1 -1 -1\n"
    "-1 1 -1\n"
    "-1 -1 1.5e0\n"
    "3 0 1 2\n"
    "3 0 3 1\n"
    "3 0 2 3\n"
    "3 1 3 2\n";

void expect_tetrahedron(const Mesh& mesh) {
  EXPECT_THAT(mesh.vertices, ElementsAre(Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1.5)));
  EXPECT_THAT(mesh.faces,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}));
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

void expect_refusal(std::string_view text, std::string_view why) {
  EXPECT_THAT([&] { parse_off(text, "x.off"); }, Refuses(why)) << text;
}

TEST(Off, ReadsWhatIsFoundInTheWild) {
  const std::string text = kTetrahedron;
  const std::vector<std::string> variants = {
      text,
      replaced(text, "\n", "\r\n"),
      replaced(text, "\n", "  # a comment\n\n# another\n\t\n"),
      replaced(text, "\n", " \t \n"),
      "\xef\xbb\xbf" + text,
      text.substr(0, text.size() - 1),            // no line end after the last face
      replaced(text, "OFF\n4 4 6", "OFF 4 4 6"),  // counts on the header's line
      replaced(text, "OFF\n4 4 6", "OFF4 4 6"),   // and glued to it
      replaced(text, "OFF\n", ""),                // no header word
      replaced(text, "4 4 6", "4 4"),             // no number of edges
      replaced(text, "4 4 6", "4 4 0"),           // a wrong one
      replaced(text, "OFF", "off"),
      replaced(replaced(text, "OFF", "COFF"), " 1\n", " 1 0.2 0.3 0.4 1\n"),
      replaced(replaced(text, "OFF", "NOFF"), " -1\n", " -1 0 0 1\n"),
      replaced(replaced(text, "OFF", "STCNOFF"), " 1\n", " 1 0 0 1 9 9 9 9 0.5 0.5\n"),
      replaced(replaced(text, "3 0 1 2", "3 0 1 2 0.5 0.5 0.5"), "3 0 3 1", "3 0 3 1 255 0 0 255"),
      replaced(text, "1 1 1\n", "+1 +1.0 1E0\n"),
  };
  for (const std::string& variant : variants) {
    SCOPED_TRACE(variant);
    expect_tetrahedron(parse_off(variant, "x.off"));
  }
}

TEST(Off, KeepsEveryDigitOfACoordinate) {
  const Mesh mesh = parse_off("OFF 1 0 0\n0.1 -2.2250738585072014e-308 123456789.123456789\n", "x.off");
  EXPECT_THAT(mesh.vertices, ElementsAre(Vec3(0.1, -2.2250738585072014e-308, 123456789.123456789)));
}

TEST(Off, NamesFileAndLineOfWhatIsWrong) {
  const std::string text = kTetrahedron;
  for (const char* vertex :
       {"1 -1 x", "1 -1", "1 nan -1", "1 -inf -1", "1 1e999 -1", "1 0x1p3 -1", "1 -1,5 -1"})
    expect_refusal(replaced(text, "1 -1 -1", vertex), "x.off:4: ");
  for (const char* face : {"3 0 4 1", "3 0 -1 1", "3 0 1.5 1", "2 0 3", "0", "-3 0 3 1", "4 0 3 1"})
    expect_refusal(replaced(text, "3 0 3 1", face), "x.off:8: ");
  expect_refusal(text + "3 0 1 3\n", "x.off:11: ");
}

TEST(Off, RefusesHeadersThatCannotBe) {
  for (const char* header :
       {"", " \n# only a comment\n", "OFF\n", "OFF BINARY\n", "4OFF\n", "nOFF\n3\n", "solid cube\n"})
    expect_refusal(header, "x.off:");
  for (const char* counts : {"4\n", "-4 4 6\n", "4 -4 6\n"})
    expect_refusal("OFF\n" + std::string(counts), "x.off:2: ");
  expect_refusal(std::string_view("\x7f"
                                  "ELF\x02\x01\0\0",
                                  8),
                 "\"?ELF????\"");
}

TEST(Off, AbsurdCountsNeedNoMemory) {
  for (const char* counts : {"1000000000000 4 6", "99999999999999999999 4 6"})
    expect_refusal(fmt::format("OFF\n{}\n0 0 0\n", counts), "x.off:2: ");
  expect_refusal("OFF\n2147483647 4 6\n0 0 0\n1 1 1\n", "2 of 2147483647 vertices");
  expect_refusal("OFF\n1 2147483647 6\n0 0 0\n", "0 of 2147483647 faces");
  expect_refusal("OFF\n1 1 0\n0 0 0\n2147483647 0 0 0 0\n", "0 of 1 faces");
}

}  // namespace
}  // namespace salbench
