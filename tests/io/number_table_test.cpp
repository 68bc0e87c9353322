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
  EXPECT_EQ(error_of("1,2\n", ""),
            "a.csv:1: the line has 2 columns, expected one value: keep that column alone, or, of ground "
            "truth, name "
            "it in the description (`column:`), or write its decimal comma as a point");
  EXPECT_EQ(
      error_of("1,2.5\n", ""),
      "a.csv:1: the line has 2 columns, expected one value: keep that column alone, or, of ground truth, "
      "name it in the description (`column:`)");
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

// --- rows that say which element they are about -----------------------------------------------------------

const Elements kVertices{4}, kFaces{4, "mesh", "face", "faces"};

ScalarField of_elements(std::string_view text, const std::string& name,
                        const Elements& elements = kVertices) {
  return parse_columns(text, "a.csv", {name}, {}, elements)[0];
}

// Shuffled rows had been read in the order of the file.
TEST(NumberTable, AColumnThatNumbersTheVerticesIsObeyed) {
  for (const char* name :
       {"vertex", "index", "id", "Vertex ID", "vertex_index", "VertexIdx", "point", "nr", "", "Unnamed: 0"}) {
    const std::string header = std::string(name) + ",saliency\n";
    EXPECT_THAT(of_elements(header + "2,0.2\n0,0\n3,0.3\n1,0.1\n", "saliency"), ElementsAre(0, 0.1, 0.2, 0.3))
        << "from 0: " << name;
    EXPECT_THAT(of_elements(header + "2,0.1\n1,0\n4,0.3\n3,0.2\n", "2"), ElementsAre(0, 0.1, 0.2, 0.3))
        << "from 1: " << name;
    EXPECT_THAT(of_elements(header + "2.0,0.2\n0e0,0\n3,0.3\n1,0.1\n", ""), ElementsAre(0, 0.1, 0.2, 0.3))
        << "the only column beside it: " << name;
  }
  EXPECT_THAT(of_elements("s;vertex\n.2;2\n0;0\n.3;3\n.1;1\n", ""), ElementsAre(0, 0.1, 0.2, 0.3));
}

// As numpy.savetxt writes it: the names stand behind '#'.
TEST(NumberTable, AHeaderMayBeAComment) {
  const std::string rows = "2 0.2\n0 0\n3 0.3\n1 0.1\n";
  EXPECT_THAT(of_elements("# vertex saliency\n" + rows, "saliency"), ElementsAre(0, 0.1, 0.2, 0.3));
  EXPECT_THAT(of_elements("# vertex saliency\n# of mesh 52, by gaze\n" + rows, "2"),
              ElementsAre(0, 0.1, 0.2, 0.3));
  EXPECT_THAT(of_elements("# of mesh 52, by gaze\n" + rows, "2"), ElementsAre(0.2, 0, 0.3, 0.1))
      << "nothing says what the first column is";
  EXPECT_EQ(error_of("# gaze, of 52\n1 2\n", "saliency"),
            "a.csv:2: no column \"saliency\": the first line has numbers, not names of columns");
}

TEST(NumberTable, TheColumnNamedAfterTheElementsNumbersThem) {
  const std::string rows = "0,9,2,0.2\n1,9,0,0\n2,9,3,0.3\n3,9,1,0.1\n";
  EXPECT_THAT(of_elements(",id,vertex,s\n" + rows, "s"), ElementsAre(0, 0.1, 0.2, 0.3));
  EXPECT_THAT(of_elements("vertex,x,face,s\n" + rows, "s", kFaces), ElementsAre(0, 0.1, 0.2, 0.3));
  EXPECT_THAT(of_elements("vertex,x,face,s\n" + rows, "s"), ElementsAre(0.2, 0, 0.3, 0.1));
  EXPECT_THAT(of_elements("x,y,id,s\n" + rows, "id"), ElementsAre(2, 0, 3, 1)) << "the values themselves";
  EXPECT_THAT(parse_columns("vertex,x\n2,9\n0,7\n1,8\n", "a.csv", {"x"})[0], ElementsAre(9, 7, 8))
      << "of points whose coordinates stand beside them";
}

std::string refusal_of_numbers(const std::string& text, const std::string& name = "s") {
  try {
    of_elements(text, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(NumberTable, NumbersOfVerticesThatAreNoneAreRefused) {
  const std::string rest =
      "; it numbers the vertices, expected each number from 0 to 3, or from 1 to 4, once: correct it, or "
      "rename "
      "it if it is something else";
  const auto refusal = [](const std::string& rows) { return refusal_of_numbers("vertex,s\n" + rows); };
  EXPECT_EQ(refusal("0,1\n1,1\n1,1\n3,1\n"), "a.csv:4: column \"vertex\" has 1 a second time" + rest);
  EXPECT_EQ(refusal("1,1\n2,1\n0,1\n4,1\n"), "a.csv:5: column \"vertex\" has 4" + rest)
      << "0 is of numbers from 0, and 4 of those from 1";
  EXPECT_EQ(refusal("1,1\n2,1\n3,1\n5,1\n"), "a.csv:5: column \"vertex\" has 5" + rest);
  EXPECT_EQ(refusal("2,1\n3,1\n4,1\n5,1\n"), "a.csv:5: column \"vertex\" has 5" + rest);
  EXPECT_EQ(refusal("0,1\n1.5,1\n2,1\n3,1\n"), "a.csv:3: column \"vertex\" has 1.5" + rest);
  EXPECT_EQ(refusal("-1,1\n1,1\n2,1\n3,1\n"), "a.csv:2: column \"vertex\" has -1" + rest);
  EXPECT_EQ(refusal("1e300,1\n1,1\n2,1\n3,1\n"), "a.csv:2: column \"vertex\" has 1e+300" + rest);
  EXPECT_EQ(refusal("v0,1\n1,1\n2,1\n3,1\n"), "a.csv:2: \"v0\" is not a number");
  EXPECT_EQ(refusal("0,1\n1,1\n2,1\n"), "a.csv:4: the file has 3 values, but the mesh has 4 vertices");
  EXPECT_EQ(refusal_of_numbers("id,index,s\n0,0,1\n1,1,1\n2,2,1\n3,3,1\n"),
            "a.csv:1: columns \"id\" and \"index\" both number the vertices: rename one");
}

// R writes a name of each row, and none above these names: the column of the name is another one.
TEST(NumberTable, NamesAboveOtherColumnsAreRefused) {
  EXPECT_EQ(refusal_of_numbers("\"s\"\n\"1\" 0.5\n"), "a.csv:2: 2 columns, but the header names 1");
  EXPECT_EQ(refusal_of_numbers("vertex s\n1 0 0.5\n", "3"), "a.csv:2: 3 columns, but the header names 2");
}

}  // namespace
}  // namespace salbench
