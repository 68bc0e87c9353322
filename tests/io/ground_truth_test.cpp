// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/shapes/values_file.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// For a mesh of two vertices.
void expect_refused_saliency(std::string_view text, std::string_view why) {
  EXPECT_THAT([&] { parse_values(text, "9.val", {2}); }, Refuses(why)) << text;
}

TEST(GroundTruthFile, ReadsOneValueALine) {
  for (const char* text :
       {"0.5\n0\n1e-3\n", "0.5\r\n0\r\n1e-3\r\n", " 0.5 \n\n0\t\n1e-3\n\n\n", "0.5\n0\n1e-3"})
    EXPECT_THAT(parse_values(text, "9.val", {3}), ElementsAre(0.5, 0, 1e-3)) << text;
}

TEST(GroundTruthFile, NamesFileAndLineOfABadValue) {
  for (const char* file : {"1\nnan\n", "1\n-inf\n", "1\nx\n", "vertex,value\n0,0.5\n1,0.25\n", "1\n2 3\n"})
    expect_refused_saliency(file, "9.val:2: ");
  for (const char* file : {"vertex value\n0 0.5\n", "1\n"}) expect_refused_saliency(file, "9.val:1: ");
  expect_refused_saliency("1\n2\n3\n", "9.val:3: ");
  expect_refused_saliency("", "9.val: ");
}

// Non-finite values of Microsoft's C library and of NumPy before 1.13; a '#' within a word is no comment.
TEST(GroundTruthFile, NamesFileAndLineOfAWordWithANumberSign) {
  for (const char* word : {"1.#INF", "-1.#INF", "1.#QNAN", "1.#SNAN", "-1.#IND", "1.#J", "12#3"}) {
    expect_refused_saliency(fmt::format("{}\n1\n", word), fmt::format("9.val:1: \"{}\"", word));
    expect_refused_saliency(fmt::format("1\r\n{}\r\n", word), fmt::format("9.val:2: \"{}\"", word));
  }
}

// As written by numpy.savetxt and pandas.
TEST(GroundTruthFile, ReadsValuesBelowCommentsAndAHeader) {
  for (const char* text : {"# saliency of vertices, mesh 9\n0.5\n0\n1e-3\n", "saliency\n0.5\n0\n1e-3\n",
                           "#\n\n # a\n0.5\n#b\n0\n1e-3\n#"})
    EXPECT_THAT(parse_values(text, "9.val", {3}), ElementsAre(0.5, 0, 1e-3)) << text;
  for (const char* text : {"# picks, from 0\n7\n0\n", "vertex\n7\n0\n", "7.000e+00\n0.0\n"})
    EXPECT_THAT(parse_picks(text, "9_0.pid", {8}), ElementsAre(7, 0)) << text;
}

TEST(GroundTruthFile, SaysWhatAnotherFileIs) {
  expect_refused_saliency("\x93NUMPY\x01\x00v", "9.val: is a .npy file of NumPy");
  expect_refused_saliency("ply\nformat ascii 1.0\n", "9.val: is a PLY file");
  EXPECT_THAT([&] { parse_picks("PK\x03\x04", "9_0.pid", {8}); }, Refuses("9_0.pid: is a zip archive"));
}

TEST(GroundTruthFile, KeepsTheOrderAndRepetitionsOfPicks) {
  EXPECT_THAT(parse_picks("7\r\n0\r\n7\r\n", "9_0.pid", {8}), ElementsAre(7, 0, 7));
  EXPECT_THAT(parse_picks("", "9_0.pid", {8}), IsEmpty());
}

TEST(GroundTruthFile, NamesFileAndLineOfABadPick) {
  for (const char* pick : {"8\n", "-1\n", "1.5\n", "nan\n", "vertex\n", "1 2\n", "99999999999999999999\n"}) {
    const std::string text = "7\n" + std::string(pick);
    EXPECT_THAT([&] { parse_picks(text, "9_0.pid", {8}); }, Refuses("9_0.pid:2: ")) << text;
  }
}

TEST(GroundTruthFile, ThereIsAValuePerPointOrPerFaceWhereFacesMayHaveValues) {
  EXPECT_NO_THROW(require_value_per_element("9.val", 4, 4, 6));
  EXPECT_NO_THROW(require_value_per_element("9.val", 6, 4, 6));
  EXPECT_NO_THROW(require_value_per_element("9.val", 4, 4));
  for (const auto& [n, n_faces] : {std::pair(5U, 6U), {7, 6}, {0, 0}, {3, 0}})
    EXPECT_THROW(require_value_per_element("9.val", n, 4, n_faces), InputError) << n << " " << n_faces;
}

}  // namespace
}  // namespace salbench
