// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/values_file.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/hdf5_file.h"
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
  return read_point_values(folder.write("out", bytes), "the output", n);
}

std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string hdf5(const std::vector<std::string>& names) {
  Hdf5Content content;
  for (const std::string& name : names)
    content.arrays.push_back({name, {3}, std::vector<float>{1, 2, 4}, "1", ""});
  const Bytes image = hdf5_image(content);
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

TEST(PointValues, AreReadFromTextNpyAndHdf5) {
  EXPECT_THAT(read("1\n2.5\n-4e-3\n"), ElementsAre(1, 2.5, -4e-3));
  EXPECT_THAT(read(npy<double>("<f8", "3,", {1, 2, 4})), ElementsAre(1, 2, 4));
  EXPECT_THAT(read(npy<float>("<f4", "3, 1", {1, 2, 4})), ElementsAre(1, 2, 4));
  EXPECT_THAT(read(hdf5({"anything"})), ElementsAre(1, 2, 4));
  EXPECT_THAT(read(hdf5({"another", "saliency"})), ElementsAre(1, 2, 4));
}

TEST(PointValues, AreRefusedWithTheReason) {
  EXPECT_THAT(refusal("1\n2\n"), HasSubstr("the output: 2 values, but the shape has 3 points"));
  EXPECT_THAT(refusal("1\n2\nfine\n"), HasSubstr("the output:3: \"fine\" is not a number"));
  EXPECT_THAT(refusal("1\n2\nnan\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2, std::nan("")})), HasSubstr("value 2 (0-based) is nan"));
  EXPECT_THAT(refusal(npy<std::int64_t>("<i8", "3,", {1, 2, 3})), HasSubstr("neither float32 nor float64"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3, 2", {1, 2, 3, 4, 5, 6})), HasSubstr("shape is (3, 2)"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2})), HasSubstr("it holds 2 values"));
  EXPECT_THAT(refusal(hdf5({"one", "two"})), HasSubstr("2 data sets of numbers"));
  EXPECT_THAT(refusal(std::string(2'000'000, '7')), HasSubstr("too many"));
}

// Damage at any place is an InputError, or another field of three finite numbers.
TEST(PointValues, SurviveACutAnywhere) {
  const std::string whole = npy<double>("<f8", "3,", {1, 2, 4});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "none") << size;
}

}  // namespace
}  // namespace salbench
