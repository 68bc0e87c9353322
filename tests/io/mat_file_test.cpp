// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mat_file.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/mat.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MatFile : public testing::Test {
 protected:
  MatFile() {
    MatWriter file(folder_ / "a.mat");
    file.write("values", {0.5, -2, 3e7});
    file.write("bytes", MAT_C_UINT8, MAT_T_UINT8, std::vector<std::uint8_t>{1, 255});
    file.write("whole", MAT_C_INT32, MAT_T_INT32, std::vector<std::int32_t>{-7});
    file.write("single", MAT_C_SINGLE, MAT_T_SINGLE, std::vector<float>{0.25F});
    file.write("none", {});
    file.write_cells("cells", 2, 2, {{11}, {21, 22}, {12}, {}});
    std::string text = "words";
    file.write("text", MAT_C_CHAR, MAT_T_UTF8, std::vector<char>(text.begin(), text.end()));
  }
  std::string bytes() const { return read_file(folder_ / "a.mat"); }
  ScalarField numbers(const std::string& variable, const std::vector<std::string>& cell = {}) const {
    return parse_mat(bytes(), "a.mat", variable, cell);
  }

  TemporaryFolder folder_;
};

std::string error_of(std::string_view bytes, const std::string& variable,
                     const std::vector<std::string>& cell = {}) {
  try {
    parse_mat(bytes, "a.mat", variable, cell);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(MatFile, ReadsNumbersOfAnyType) {
  EXPECT_THAT(numbers("values"), ElementsAre(0.5, -2, 3e7));
  EXPECT_THAT(numbers("bytes"), ElementsAre(1, 255));
  EXPECT_THAT(numbers("whole"), ElementsAre(-7));
  EXPECT_THAT(numbers("single"), ElementsAre(0.25));
  EXPECT_THAT(numbers("none"), IsEmpty());
}

TEST_F(MatFile, ReadsACellByRowAndColumn) {
  EXPECT_THAT(numbers("cells", {"1", "1"}), ElementsAre(11));
  EXPECT_THAT(numbers("cells", {"2", "1"}), ElementsAre(21, 22));
  EXPECT_THAT(numbers("cells", {"1", "2"}), ElementsAre(12));
  EXPECT_THAT(numbers("cells", {"2", "2"}), IsEmpty());
}

TEST_F(MatFile, ValuesAreARowOrAColumnOfNumbersThatDoublesHold) {
  constexpr std::int64_t kBeyond = (1LL << 53) + 1;
  {
    MatWriter file(folder_ / "a.mat");
    const std::vector<double> numbers = {1, 2, 3, 4};
    file.write("row", 1, 4, numbers);
    file.write("column", 4, 1, numbers);
    file.write("square", 2, 2, numbers);
    file.write("largest", MAT_C_INT64, MAT_T_INT64, std::vector<std::int64_t>{kBeyond - 1, 1 - kBeyond});
    file.write("beyond", MAT_C_INT64, MAT_T_INT64, std::vector<std::int64_t>{-kBeyond});
    file.write("unsigned", MAT_C_UINT64, MAT_T_UINT64, std::vector<std::uint64_t>{std::uint64_t{1} << 63U});
  }
  const auto said = [&](const char* variable) {
    try {
      parse_mat_values(bytes(), "a.mat", variable);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(parse_mat_values(bytes(), "a.mat", "row"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(parse_mat_values(bytes(), "a.mat", "column"), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(said("square"), "a.mat: variable \"square\": its shape is (2, 2), expected a row or a column");
  EXPECT_THAT(numbers("square"), ElementsAre(1, 2, 3, 4)) << "picks may be in any shape";
  EXPECT_THAT(numbers("largest"), ElementsAre(0x1p53, -0x1p53));
  EXPECT_THAT(said("beyond"), HasSubstr("it holds -9007199254740993: whole numbers beyond 2^53"));
  EXPECT_THAT(said("unsigned"), HasSubstr("it holds 9223372036854775808: whole numbers beyond 2^53"));
}

TEST_F(MatFile, SaysWhatWasExpected) {
  EXPECT_THAT(error_of(bytes(), "value"),
              HasSubstr("a.mat: no variable \"value\"; the file has \"values\", \"bytes\""));
  EXPECT_EQ(error_of(bytes(), ""), "a.mat: a MAT file, and the description names no `variable:` in it");
  EXPECT_EQ(error_of(bytes(), "cells"),
            "a.mat: variable \"cells\": it is a cell array: name one with `cell: [row, column]`");
  EXPECT_EQ(error_of(bytes(), "cells", {"3", "8"}),
            "a.mat: variable \"cells\": it has 2 x 2 cells, expected cell 3, 8");
  EXPECT_EQ(error_of(bytes(), "values", {"1", "1"}),
            "a.mat: variable \"values\": it is not a cell array: leave out `cell:`");
  EXPECT_EQ(error_of(bytes(), "text"), "a.mat: variable \"text\": it holds no numbers");
  EXPECT_THAT(error_of("1\n2\n", "a"), HasSubstr("expected a file of MATLAB, version 5"));
  std::string newer = bytes();
  newer.replace(124, 2, std::string("\0\2", 2));
  EXPECT_THAT(error_of(newer, "values"), HasSubstr("version 7.3 is HDF5; save it with -v7"));
}

TEST_F(MatFile, BytesThatAreCutOrChangedAreRefusedOrRead) {
  const std::string whole = bytes();
  for (std::size_t length = 0; length < whole.size(); length += 23) {
    const std::string error = error_of(whole.substr(0, length), "cells", {"2", "1"});
    EXPECT_TRUE(error.starts_with("a.mat: ") || error == "no error") << length << ": " << error;
  }
  for (std::size_t i = 128; i < whole.size(); i += 7) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    const std::string error = error_of(changed, "cells", {"2", "1"});
    EXPECT_TRUE(error.starts_with("a.mat: ") || error == "no error") << i << ": " << error;
  }
}

TEST_F(MatFile, IsReadByManyThreads) {
  const std::string whole = bytes();
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back(
        [&] { EXPECT_THAT(parse_mat(whole, "a.mat", "values"), ElementsAre(0.5, -2, 3e7)); });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace salbench
