// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/values_file.h"

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

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

struct NpyRow {
  std::string header;
  std::string values;  // their bytes
  std::string expected;
};

template <class Number>
std::string bytes_of(std::initializer_list<Number> numbers) {
  return {reinterpret_cast<const char*>(std::data(numbers)), numbers.size() * sizeof(Number)};
}

std::string with_header(const std::string& header, const std::string& values, char version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += {version, '\0', static_cast<char>(header.size() % 256), static_cast<char>(header.size() / 256)};
  if (version > 1) bytes += {'\0', '\0'};
  return bytes + header + values;
}

// The values, or why they are refused.
std::string outcome(const std::string& bytes) {
  try {
    return fmt::format("{}", fmt::join(read(bytes), " "));
  } catch (const InputError& error) {
    constexpr std::string_view kBefore = "the output: not a .npy file that can be read: ";
    return std::string(error.what()).substr(kBefore.size());
  }
}

// What is read, and of which headers, types and orders of bytes: tests/pipeline/npy_twin_test.py, against
// NumPy itself. Here is what the reasons say.
TEST(PointValues, OfNpyAreRefusedWithTheReason) {
  const std::string doubles = bytes_of<double>({1, 2, 4});
  const auto header = [](const std::string& type, const std::string& shape = "(3,)") {
    return fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", type, shape);
  };
  for (const auto& [text, values, expected] : std::vector<NpyRow>{
           {header("'<u8'"), bytes_of<std::uint64_t>({1, 2, 1ULL << 63}),
            "it holds 9223372036854775808: whole numbers beyond 2^53 cannot be used, scale them"},
           {header("'<i8'"), bytes_of<std::int64_t>({1, 2, -(1LL << 53) - 1}),
            "it holds -9007199254740993: whole numbers beyond 2^53 cannot be used, scale them"},
           {header("'|f1'"), "123",
            "its type is \"|f1\", expected float16, float32, float64, or whole numbers"},
           {header("[('<f8', '<f4'), ('b', '<i4')]"), doubles,
            "its type is \"[('<f8', '<f4'), ('b', '<i4')]\", expected numbers"},
           {header("'<f8'", "()"), doubles, "its shape is (), expected one value per point"},
           {header("'<f8'", "(3, 2)"), doubles, "its shape is (3, 2), expected one value per point"},
           {header("'<f8'", "(3)"), doubles, "its shape is a number, expected a tuple of them"},
           {header("'<f8'", "(4,)"), doubles, "its shape is (4), and it holds 24 bytes of values"},
           {header("'<f8'", "(2305843009213693955,)"), doubles,
            "its shape is (2305843009213693955), and it holds 24 bytes of values"},
           {"{'descr': '<f8', 'fortran_order': False}", doubles, "its header names no shape"},
           {"{'fortran_order': False, 'shape': (3,)}", doubles, "its header names no type"},
           {"{'shape': (3,), 'shape': (3,)}", doubles, "its header has \"shape\", or has it twice"},
           {"{'descr': '<f8', 'fortran_order': 1}", doubles,
            "its header has \"1}\" where True or False is expected"},
           {"{'descr': '<f8' 'shape': (3,)}", doubles,
            "its header has \"'shape': (3,)}\" where '}' is expected"},
           {"{'descr': '<f8', 'shape': (3,)} x", doubles, "its header has \"x\" where nothing is expected"},
           {"{'descr", doubles, "its header has \"'descr\" where a text in quotes is expected"},
           {"{'descr': '<f\\x38'}", doubles,
            "its header has \"'<f\\x38'}\" where a text without escapes is expected"},
           {"", doubles, "its header has \"\" where '{' is expected"}})
    EXPECT_EQ(outcome(with_header(text, values)), expected) << text;
  EXPECT_EQ(outcome(with_header(header("'<f8'"), doubles, '\4')), "its version is 4.0, expected 1.0 to 3.0");
}

// Damage at any place is an InputError, or another field of three finite numbers.
TEST(PointValues, SurviveACutAnywhere) {
  const std::string whole = npy<double>("<f8", "3,", {1, 2, 4});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "none") << size;
}

}  // namespace
}  // namespace salbench
