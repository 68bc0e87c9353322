// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/table.h"

#include "stages/core/rng.h"
#include "tests/support/columns.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

void expect_refusal(std::string_view csv, std::string_view why) {
  EXPECT_THAT([&] { parse_csv(csv, "x.csv"); }, Refuses(why)) << csv;
}

TEST(Csv, WritesWhatItMustQuoteInQuotes) {
  const Table table{
      {"item", "n, of", "auc"},
      {{"52", std::int64_t{7}, 0.1}, {"a \"b\"", std::int64_t{-1}, kNan}, {"c\nd", std::int64_t{0}, 1e300}}};
  EXPECT_EQ(to_csv(table), "item,\"n, of\",auc\n52,7,0.1\n\"a \"\"b\"\"\",-1,\n\"c\nd\",0,1e+300\n");
}

TEST(Csv, ReadsBackEveryTextItWrites) {
  const std::vector<std::string> texts = {"",     "plain", " spaced ",   "a,b", "\"",
                                          "\"\"", "\r\n",  "two\nlines", "ä"};
  Table table{{"text", "comma,name"}, {}};
  for (const std::string& text : texts) table.rows.push_back({text, text + "x"});
  const Table back = parse_csv(to_csv(table), "x.csv");
  EXPECT_EQ(back.columns, table.columns);
  EXPECT_EQ(back.rows, table.rows);

  Table narrow{{"text"}, {}};  // empty fields would become blank lines
  for (const std::string& text : texts) narrow.rows.push_back({text});
  EXPECT_EQ(text_column(parse_csv(to_csv(narrow), "x.csv"), "text"), texts);
}

TEST(Csv, DoublesReadBackToTheSameValue) {
  Rng rng(3, "table", "");
  std::vector<double> values = {0, -0.0, 0.1, 1.0 / 3, 5e-324, -1.7976931348623157e308, kInfinity};
  for (int i = 0; i < 2000; ++i)
    values.push_back(std::ldexp(rng.uniform() - 0.5, static_cast<int>(rng.below(2000)) - 1000));
  Table table{{"value"}, {}};
  for (const double value : values) table.rows.push_back({value});
  EXPECT_EQ(number_column(parse_csv(to_csv(table), "x.csv"), "value"), values);
  EXPECT_TRUE(std::isnan(number_column(parse_csv(to_csv({{"v"}, {{kNan}}}), "x.csv"), "v").at(0)));
}

TEST(Csv, ReadsFilesOfOtherPrograms) {
  const Table table = parse_csv(
      "\xef\xbb\xbf"
      "a,b\r\n\r\n\"1\",2\r\n3,4",
      "x.csv");
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  EXPECT_THAT(number_column(table, "a"), ElementsAre(1, 3));
  EXPECT_THAT(text_column(table, "b"), ElementsAre("2", "4"));
  EXPECT_THAT(table.lines, ElementsAre(3, 4));
}

// Earlier, a remark with a comma became the header, and only the last of several was kept.
TEST(Csv, LinesAboveTheHeaderThatBeginWithAHashAreRemarks) {
  const Table table = parse_csv(
      "\xef\xbb\xbf# PARTIAL: 3 of 4, so far\r\n\n#SIMULATED, \"by chance\r\n#\na,b\n1,# 2\n", "x.csv");
  EXPECT_THAT(table.remarks, ElementsAre("PARTIAL: 3 of 4, so far", "SIMULATED, \"by chance", ""));
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  EXPECT_THAT(text_column(table, "b"), ElementsAre("# 2"));
  EXPECT_THAT(table.lines, ElementsAre(6));
  expect_refusal("# a, b\n", "x.csv:");
  expect_refusal("a,b\n# c, d, e\n", "x.csv:2:");
}

TEST(Csv, RemarksStandInALastColumnAndAreNoneOfTheTables) {
  struct Case {
    std::vector<std::string> remarks;
    std::string csv;
  };
  const std::vector<Case> cases = {
      {{}, "a,b\n1,2\n3,4\n"},
      {{"so far"}, "a,b,remarks\n1,2,so far\n3,4,so far\n"},
      {{"so far, and \"on\"", "x"},
       "a,b,remarks\n1,2,\"so far, and \"\"on\"\" | x\"\n3,4,\"so far, and \"\"on\"\" | x\"\n"},
      {{"a | b", "|", "||c d|"}, "a,b,remarks\n1,2,a || b | || | ||||c d||\n3,4,a || b | || | ||||c d||\n"}};
  for (const auto& [remarks, csv] : cases) {
    EXPECT_EQ(to_csv({.columns = {"a", "b"}, .rows = {{"1", "2"}, {"3", "4"}}, .remarks = remarks}), csv);
    const Table table = parse_csv(csv, "x.csv");
    EXPECT_EQ(table.remarks, remarks);
    EXPECT_THAT(table.columns, ElementsAre("a", "b"));
    EXPECT_THAT(text_column(table, "b"), ElementsAre("2", "4"));
  }
  EXPECT_EQ(to_csv({.columns = {"a"}, .rows = {}, .remarks = {"so far"}}), "a,remarks\n");
}

TEST(Csv, RemarksOfSeveralTablesAreReadOnceEachInTheirOrder) {
  for (const char* csv :
       {"# x\n# y\na,remarks\n1,y | z\n", "a,remarks\n1,\n2,x | y\n3,z\n4,y | x\n",
        "remarks,a\nx | y,1\nz,2\n", "# x\na,remarks\n1,y\n2,z\n3,y\n", "# x\n# x\n# y\n# z\na\n"})
    EXPECT_THAT(parse_csv(csv, "x.csv").remarks, ElementsAre("x", "y", "z")) << csv;
}

TEST(Csv, NamesFileAndLineOfWhatIsWrong) {
  for (const char* csv : {"", "\n\n"}) expect_refusal(csv, "x.csv: ");
  for (const char* csv : {"a,b\n1,\"2\n", "a,b\n1,\"2\"3\n"}) expect_refusal(csv, "x.csv:2: ");
  expect_refusal("a,b\n1,2\n3\n", "x.csv:3: ");
  expect_refusal("a,b\n\"1\n1\",2\n1,2,3\n", "x.csv:4: ");
  expect_refusal("a,b,a\n", "x.csv:1: ");
}

TEST(Csv, AnyCutOfAFileIsReadOrRefused) {
  const std::string csv = "a,\"b\"\"c\"\n\"x\ny\",\"2\"\r\n3,4\n";
  for (std::size_t length = 0; length < csv.size(); ++length) {
    try {
      EXPECT_LE(parse_csv(csv.substr(0, length), "x.csv").rows.size(), 2U);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith("x.csv"));
    }
  }
}

TEST(Aligned, PutsNumbersToTheRight) {
  const Table table{
      {"model", "auc", "n"},
      {{"LS", 0.62849, std::int64_t{400}}, {"Größe", -12.5, std::int64_t{7}}, {"", kNan, std::int64_t{0}}}};
  EXPECT_EQ(aligned(table, 3),
            "model      auc    n\n"
            "LS       0.628  400\n"
            "Größe  -12.500    7\n"
            "             -    0\n");
}

TEST(ReadCsv, RefusesWhatIsTooLargeForATableBeforeItIsRead) {
  const TemporaryFolder folder;
  folder.write("huge.csv", "a,b\n");
  std::filesystem::resize_file(folder / "huge.csv", 8ULL << 30U);  // a sparse file
  EXPECT_THAT([&] { read_csv(folder / "huge.csv"); }, Refuses("huge.csv:"));
}

TEST(Aligned, ShowsTheMagnitudeOfWhatWouldReadAsZero) {
  EXPECT_EQ(aligned({{"p"}, {{3.2e-12}, {0.0}, {0.0004}}}, 4), "      p\n3.2e-12\n 0.0000\n 0.0004\n");
}

}  // namespace
}  // namespace salbench
