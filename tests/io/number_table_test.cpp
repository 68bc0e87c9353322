// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/number_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsNan;

ScalarField column(std::string_view text, const std::string& name, const std::string& unseen = {}) {
  return parse_columns(text, "a.csv", {name}, unseen)[0];
}

std::string error_of(std::string_view text, const std::string& name,
                     const std::optional<Elements>& expected = {}) {
  try {
    parse_columns(text, "a.csv", {name}, "", expected);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(NumberTable, ReadsAColumnByNumberOrName) {
  EXPECT_THAT(column("1,2\n3,4\n", "2"), ElementsAre(2, 4));
  EXPECT_THAT(column("x,\"saliency\"\r\n1,2\r\n\r\n3,4\r\n", "saliency"), ElementsAre(2, 4));
  EXPECT_THAT(column("x y\n1 2\n", "1"), ElementsAre(1)) << "a header is no value, whatever names the column";
  EXPECT_THAT(column("1.5e0\t-2 \n+3\t4", "2"), ElementsAre(-2, 4));
  EXPECT_THAT(column("1; 2\n3; 4", "2"), ElementsAre(2, 4));
  EXPECT_THAT(column("\xef\xbb\xbfvalue\n7\n", "value"), ElementsAre(7)) << "a byte order mark";
}

TEST(NumberTable, ReadsTheOnlyColumnWithoutAName) {
  EXPECT_THAT(column("1\n2\n", ""), ElementsAre(1, 2));
  EXPECT_THAT(column("saliency\n1\n2\n", ""), ElementsAre(1, 2));
}

TEST(NumberTable, ReadsSeveralColumnsInTheOrderAskedFor) {
  EXPECT_THAT(parse_columns("x y z s\n1 2 3 4\n5 6 7 8", "a", {"s", "x", "2"}),
              ElementsAre(ElementsAre(4, 8), ElementsAre(1, 5), ElementsAre(2, 6)));
}

TEST(NumberTable, UnseenIsNaN) {
  EXPECT_THAT(column("-1\n0\n-1.0\n", "", "-1"), ElementsAre(IsNan(), 0, IsNan()));
  EXPECT_THAT(column("nan\n0\nNaN\n", "", "nan"), ElementsAre(IsNan(), 0, IsNan()));
}

TEST(NumberTable, NamesFileLineAndWhatWasExpected) {
  EXPECT_EQ(error_of("x,s\n1,2\n", "saliency"),
            "a.csv:1: no column \"saliency\": the header has \"x\", \"s\"");
  EXPECT_EQ(error_of("1,2\n", "saliency"),
            "a.csv:1: no column \"saliency\": the first line has numbers, not names of columns");
  EXPECT_EQ(error_of("1 2\n3\n", "2"), "a.csv:2: the line has 1 column, expected column 2");
  EXPECT_EQ(error_of("x,s\n1,2\n3\n", "s"), "a.csv:3: the line has 1 column, expected column \"s\"");
  EXPECT_EQ(
      error_of("1,2\n", ""),
      "a.csv:1: the line has 2 columns, and the description names none: add `column:`, or write its decimal "
      "comma as a point");
  EXPECT_EQ(error_of("1,2.5\n", ""),
            "a.csv:1: the line has 2 columns, and the description names none: add `column:`");
  EXPECT_EQ(error_of("1\nx\n", "1"), "a.csv:2: \"x\" is not a number");
  EXPECT_EQ(error_of("1,\n2,3\n", "2"), "a.csv:1: \"\" is not a number");
  EXPECT_EQ(error_of("1\n\n2\n", "1", {{3, "mesh", "face", "faces"}}),
            "a.csv:3: the file has 2 values, but the mesh has 3 faces");
  EXPECT_EQ(error_of("s\n", "1"), "a.csv:1: the file has no values");
  EXPECT_EQ(error_of("inf\n", "1"), "a.csv:1: \"inf\" is not a finite number");
  EXPECT_EQ(error_of("1\n1e999\n", "1"), "a.csv:2: \"1e999\" does not fit a double");
  EXPECT_EQ(error_of("1\n1e-999\n", "1"), "a.csv:2: \"1e-999\" does not fit a double");
  EXPECT_EQ(error_of("1\n+-1\n", "1"), "a.csv:2: \"+-1\" is not a number");
}

// They had been read as zeros.
TEST(NumberTable, DecimalCommasAreNamed) {
  EXPECT_EQ(error_of("saliency\n0,5\n", ""),
            "a.csv:2: \"0,5\" is not a number: write its decimal comma as a point");
  EXPECT_EQ(error_of("1\n-0,5e-3\n", "1"),
            "a.csv:2: \"-0,5e-3\" is not a number: write its decimal comma as a point");
  for (const char* separator : {";", "\t", " "}) {
    const auto line = [&](const char* a, const char* b) { return std::string(a) + separator + b + "\n"; };
    const std::string named = ":1: \"0,5\" is not a number: write its decimal comma as a point";
    EXPECT_EQ(error_of(line("0,5", "1"), "1"), "a.csv" + named);
    EXPECT_EQ(error_of(line("1", "0,5") + line("1", "0,7"), "2"), "a.csv" + named);
    EXPECT_EQ(error_of(line("x", "s") + line("0,5", "7"), "x"),
              "a.csv:2: \"0,5\" is not a number: write its decimal comma as a point");
  }
}

// Commas alone: what stands before one is a column, as far as can be told.
TEST(NumberTable, CommasThatMayBeDecimalOnesAreNamed) {
  const std::string zeros =
      "whole numbers between commas, some with zeros in front: write decimal commas, if these are some, as "
      "points, "
      "or name the columns in a first line";
  for (const char* column : {"1", "2"}) {
    EXPECT_EQ(error_of("0,5\n0,05\n", column), "a.csv:2: " + zeros);
    EXPECT_EQ(error_of("0,5\n1\n", column),
              "a.csv:2: 1 columns between commas, but the first line has 2: write decimal commas, if these "
              "are some, "
              "as points");
    EXPECT_EQ(error_of("x,s\n0,1,0,5\n", column),
              "a.csv:2: 4 columns between commas, but the first line has 2: write decimal commas, if these "
              "are some, "
              "as points");
  }
  EXPECT_EQ(error_of("-0,125,1,01,2,5,0,75\n", "4"), "a.csv:1: " + zeros);
}

TEST(NumberTable, OtherTextsBetweenCommasAreReadAsTheyStand) {
  EXPECT_THAT(column("0,5\n1,7\n", "2"), ElementsAre(5, 7)) << "whole numbers";
  EXPECT_THAT(column("id,s\n007,0.5\n1,05\n", "s"), ElementsAre(0.5, 5)) << "with a header";
  EXPECT_THAT(column("007,0.5\n011,1\n", "2"), ElementsAre(0.5, 1)) << "zeros in front of the first";
  EXPECT_THAT(column("0.25,007\n1,008.\n", "1"), ElementsAre(0.25, 1)) << "decimal points";
  EXPECT_THAT(column("x,s\n1,2,\n3,4\n", "s"), ElementsAre(2, 4)) << "an empty cell at the end";
  EXPECT_THAT(column("1,2,\n3,4\n", "2"), ElementsAre(2, 4));
  EXPECT_THAT(column("1, 2,3\n4, 5,6\n", "2"), ElementsAre(2, 5)) << "blanks behind commas";
}

}  // namespace
}  // namespace salbench
