// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/dataset.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/values_file.h"
#include "tests/support/data.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

void expect_refused_saliency(std::string_view text, std::size_t n, std::string_view why) {
  EXPECT_THAT([&] { parse_values(text, "9.val", {n}); }, Refuses(why)) << text;
}

void expect_refused_picks(std::string_view text, std::size_t n, std::string_view why) {
  EXPECT_THAT([&] { parse_picks(text, "9_0.pid", {n}); }, Refuses(why)) << text;
}

TEST(GroundTruthFile, ReadsOneValueALine) {
  for (const char* text :
       {"0.5\n0\n1e-3\n", "0.5\r\n0\r\n1e-3\r\n", " 0.5 \n\n0\t\n1e-3\n\n\n", "0.5\n0\n1e-3"})
    EXPECT_THAT(parse_values(text, "9.val", {3}), ElementsAre(0.5, 0, 1e-3)) << text;
}

TEST(GroundTruthFile, NamesFileAndLineOfABadValue) {
  for (const char* file : {"1\nnan\n", "1\n-inf\n", "1\nx\n", "vertex,value\n0,0.5\n1,0.25\n", "1\n2 3\n"})
    expect_refused_saliency(file, 2, "9.val:2: ");
  for (const char* file : {"vertex value\n0 0.5\n", "1\n"}) expect_refused_saliency(file, 2, "9.val:1: ");
  expect_refused_saliency("1\n2\n3\n", 2, "9.val:3: the file has 3 values, but the mesh has 2");
  expect_refused_saliency("", 2, "9.val: ");
}

// Non-finite values of Microsoft's C library and of NumPy before 1.13; a '#' within a word is no comment.
TEST(GroundTruthFile, NamesFileAndLineOfAWordWithANumberSign) {
  for (const char* word : {"1.#INF", "-1.#INF", "1.#QNAN", "1.#SNAN", "-1.#IND", "1.#J", "12#3"}) {
    for (const char* format : {"{}\n1\n", "1\r\n{}\r\n"}) {
      const std::string text = fmt::format(fmt::runtime(format), word);
      const int line = text.starts_with(word) ? 1 : 2;
      expect_refused_saliency(text, 2, fmt::format("9.val:{}: \"{}\" is not a number", line, word));
    }
  }
}

// As written by numpy.savetxt and pandas.
TEST(GroundTruthFile, ReadsValuesBelowCommentsAndAHeader) {
  for (const char* text : {"# saliency of vertices, mesh 9\n0.5\n0\n1e-3\n", "saliency\n0.5\n0\n1e-3\n",
                           "#\n\n # a\n0.5\n#b\n0\n1e-3\n#"})
    EXPECT_THAT(parse_values(text, "9.val", {3}), ElementsAre(0.5, 0, 1e-3)) << text;
  EXPECT_THAT(parse_picks("# picks, from 0\n7\n0\n", "9_0.pid", {8}), ElementsAre(7, 0));
}

TEST(GroundTruthFile, KeepsTheOrderAndRepetitionsOfPicks) {
  EXPECT_THAT(parse_picks("7\r\n0\r\n7\r\n", "9_0.pid", {8}), ElementsAre(7, 0, 7));
  EXPECT_THAT(parse_picks("", "9_0.pid", {8}), IsEmpty());
}

TEST(GroundTruthFile, NamesFileAndLineOfABadPick) {
  expect_refused_picks("7\n8\n", 8, "9_0.pid:2: vertex 8");
  for (const char* pick : {"-1\n", "1.5\n", "1 2\n", "99999999999999999999\n"})
    expect_refused_picks(pick, 8, "9_0.pid:1: ");
}

TEST(GroundTruthFile, ReadsTheStudysFiles) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  int with_truth = 0;
  for (const Item& item : native_dataset(*data, kSchelling).items) {
    if (item.saliency.empty()) continue;
    SCOPED_TRACE(item.name);
    const std::size_t n = read_mesh(item.file).vertices.size();
    GroundTruth truth{parse_values(read_file(item.saliency), item.saliency, {n}), {}};
    for (const auto& path : item.picks) truth.picks.push_back(parse_picks(read_file(path), path, {n}));
    ++with_truth;
    EXPECT_GE(truth.picks.size(), 22U);
    // A picked vertex has at least that person's share of saliency.
    for (const auto& picks : truth.picks)
      for (const std::int32_t vertex : picks)
        EXPECT_GE(truth.saliency[static_cast<std::size_t>(vertex)],
                  0.999 / static_cast<double>(truth.picks.size()));
  }
  EXPECT_EQ(with_truth, 19);
}

TEST(GroundTruthFile, ThereIsAValuePerPointOrPerFaceWhereFacesMayHaveValues) {
  EXPECT_NO_THROW(require_value_per_element("9.val", 4, 4, 6));
  EXPECT_NO_THROW(require_value_per_element("9.val", 6, 4, 6));
  EXPECT_NO_THROW(require_value_per_element("9.val", 4, 4));
  EXPECT_THAT([] { require_value_per_element("9.val", 5, 4, 6); }, Refuses("9.val: 5 values"));
  EXPECT_THAT([] { require_value_per_element("9.val", 0, 4); }, Refuses("9.val: 0 values"));
}

}  // namespace
}  // namespace salbench
