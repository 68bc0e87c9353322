// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/shapes/dataset.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/values_file.h"
#include "stages/core/errors.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

void expect_refused_saliency(std::string_view text, std::size_t n, std::string_view why) {
  EXPECT_THAT([&] { parse_values(text, "9.val", {n}); }, ThrowsMessage<InputError>(HasSubstr(why))) << text;
}

void expect_refused_picks(std::string_view text, std::size_t n, std::string_view why) {
  EXPECT_THAT([&] { parse_picks(text, "9_0.pid", {n}); }, ThrowsMessage<InputError>(HasSubstr(why))) << text;
}

TEST(GroundTruthFile, ReadsOneValueALine) {
  for (const char* text :
       {"0.5\n0\n1e-3\n", "0.5\r\n0\r\n1e-3\r\n", " 0.5 \n\n0\t\n1e-3\n\n\n", "0.5\n0\n1e-3"})
    EXPECT_THAT(parse_values(text, "9.val", {3}), ElementsAre(0.5, 0, 1e-3)) << text;
}

TEST(GroundTruthFile, NamesFileAndLineOfABadValue) {
  expect_refused_saliency("1\nnan\n", 2, "9.val:2: \"nan\" is not a finite number");
  expect_refused_saliency("1\n-inf\n", 2, "9.val:2: \"-inf\" is not a finite number");
  expect_refused_saliency("1\nx\n", 2, "9.val:2: \"x\" is not a number");
  expect_refused_saliency("vertex,value\n0,0.5\n1,0.25\n", 2, "9.val:2: \"0,0.5\" is not a number");
  expect_refused_saliency("vertex value\n0 0.5\n", 2, "9.val:1: the line has more than one column");
  expect_refused_saliency("1\n2 3\n", 2, "9.val:2: the line has more than one column, expected one value");
  expect_refused_saliency("1\n2\n3\n", 2, "9.val:3: the file has 3 values, but the mesh has 2 vertices");
  expect_refused_saliency("1\n", 2, "9.val:1: the file has 1 values, but the mesh has 2 vertices");
  expect_refused_saliency("", 2, "9.val: the file has 0 values");
}

// As Microsoft's C library and NumPy before 1.13 wrote what is not finite; a '#' within a word is no comment.
TEST(GroundTruthFile, NamesFileAndLineOfAWordWithANumberSign) {
  for (const char* word : {"1.#INF", "-1.#INF", "1.#QNAN", "1.#SNAN", "-1.#IND", "1.#J", "12#3"}) {
    for (const char* format : {"{}\n1\n", "1\r\n{}\r\n"}) {
      const std::string text = fmt::format(fmt::runtime(format), word);
      const int line = text.starts_with(word) ? 1 : 2;
      expect_refused_saliency(text, 2, fmt::format("9.val:{}: \"{}\" is not a number", line, word));
    }
  }
}

// As numpy.savetxt and pandas write it.
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
  expect_refused_picks("7\n8\n", 8,
                       "9_0.pid:2: vertex 8 is out of range: the mesh has 8 vertices, numbered from 0");
  expect_refused_picks("-1\n", 8, "9_0.pid:1: vertex -1 is out of range");
  expect_refused_picks("1.5\n", 8, "9_0.pid:1: \"1.5\" is not a whole number");
  expect_refused_picks("1 2\n", 8, "9_0.pid:1: the line has more than one value");
  expect_refused_picks("99999999999999999999\n", 8, "does not fit 64 bits");
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
    // A vertex that somebody picked has at least that person's share of saliency.
    for (const auto& picks : truth.picks)
      for (const std::int32_t vertex : picks)
        EXPECT_GE(truth.saliency[static_cast<std::size_t>(vertex)],
                  0.999 / static_cast<double>(truth.picks.size()));
  }
  EXPECT_EQ(with_truth, 19);
}

}  // namespace
}  // namespace salbench
