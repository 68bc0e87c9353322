// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/values_file.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
std::string npy(const std::string& type, const std::string& shape, const std::vector<Number>& values) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }\n";
  std::string bytes = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header;
  return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
}

ScalarField read(const std::string& bytes, std::size_t n = 3) {
  const TemporaryFolder folder;
  // What is read of HDF5 is the package's matter: here it is the size of the file.
  return read_point_values(folder.write("out", bytes), "the output", n,
                           [&](const std::filesystem::path& path) {
                             return ScalarField(n, static_cast<double>(std::filesystem::file_size(path)));
                           });
}

std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(PointValues, AreReadFromTextNpyAndHdf5) {
  EXPECT_THAT(read("1\n2.5\n-4e-3\n"), ElementsAre(1, 2.5, -4e-3));
  EXPECT_THAT(read(npy<double>("<f8", "3,", {1, 2, 4})), ElementsAre(1, 2, 4));
  EXPECT_THAT(read(npy<float>("<f4", "3, 1", {1, 2, 4})), ElementsAre(1, 2, 4));
  EXPECT_THAT(read("\x89HDF\r\n\x1a\n ..."), ElementsAre(12, 12, 12));
}

TEST(PointValues, AreRefusedWithTheReason) {
  EXPECT_THAT(refusal("1\n2\n"), HasSubstr("the output: 2 values, but the shape has 3 points"));
  EXPECT_THAT(refusal("1\n2\nfine\n"), HasSubstr("the output:3: \"fine\" is not a number"));
  EXPECT_THAT(refusal("1\n2\nnan\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2, std::nan("")})), HasSubstr("value 2 (0-based) is nan"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3, 2", {1, 2, 3, 4, 5, 6})), HasSubstr("shape is (3, 2)"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2})), HasSubstr("it holds 16 bytes of values"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2, 3}) + "x"), HasSubstr("it holds 25 bytes of values"));
  EXPECT_THAT(refusal(std::string(2'000'000, '7')), HasSubstr("too many"));
}

TEST(PointValues, OfOtherTypesInNpyAreRefused) {
  for (const char* type : {"<f2", "<f16", ">f8", ">f4", "=f8", "<i8", "|u1", "|b1", "<c8", "|O"})
    EXPECT_THAT(refusal(npy<double>(type, "3,", {1, 2, 4})),
                HasSubstr(fmt::format("its type is \"'{}'\", neither float32 nor float64", type)));
  // As numpy writes a record of a float and an integer, which is as long as a double.
  std::string records = npy<double>("[]", "3,", {1, 2, 4});
  records.replace(records.find("'[]'"), 4, "[('<f8', '<f4'), ('b', '<i4')]");
  records[8] = static_cast<char>(records[8] + 26);
  EXPECT_THAT(refusal(records), HasSubstr("its type is \"[('<f8', '<f4'), ('b', '<i4')]\""));
}

TEST(PointValues, InARowAreThoseInAColumn) {
  EXPECT_THAT(read(npy<double>("<f8", "1, 3", {1, 2, 4})), ElementsAre(1, 2, 4));
  for (const char* shape : {"", "3, 2", "3 1", "x", "-3,", "3L,", "99999999999999999999,"})
    EXPECT_THAT(refusal(npy<double>("<f8", shape, {1, 2, 4})), HasSubstr("shape")) << shape;
}

// Damage at any place is an InputError, or another field of three finite numbers.
TEST(PointValues, SurviveACutAnywhere) {
  const std::string whole = npy<double>("<f8", "3,", {1, 2, 4});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "none") << size;
}

}  // namespace
}  // namespace salbench
