// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/values_file.h"

#include <atomic>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/hdf5_file.h"
#include "stages/core/errors.h"
#include "stages/core/rng.h"
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
  EXPECT_THAT(refusal(npy<double>("<f8", "3, 2", {1, 2, 3, 4, 5, 6})), HasSubstr("shape is (3, 2)"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2})), HasSubstr("it holds 16 bytes of values"));
  EXPECT_THAT(refusal(npy<double>("<f8", "3,", {1, 2, 3}) + "x"), HasSubstr("it holds 25 bytes of values"));
  EXPECT_THAT(refusal(hdf5({"one", "two"})), HasSubstr("2 data sets of numbers"));
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

// The library does not survive all of these: a child process calls it.
TEST(PointValues, OfDamagedHdf5FilesAreReadOrRefused) {
  const std::string sound = hdf5({"one"});
  Rng rng(1, "damage", "");
  int refused = 0;
  for (int trial = 0; trial < 150; ++trial) {
    std::string bytes = sound;
    for (int change = 0; change < 4; ++change)
      bytes[8 + rng.below(bytes.size() - 8)] = static_cast<char>(rng.below(256));
    const std::string said = refusal(bytes);
    EXPECT_TRUE(said == "none" || said.starts_with("the output: ")) << said;
    refused += said == "none" ? 0 : 1;
  }
  EXPECT_GT(refused, 5);
}

// Others are inside the library all the time: a child process that inherits its lock would wait for ever.
TEST(PointValues, AreReadFromHdf5BesideThreadsThatWriteIt) {
  std::atomic<bool> done = false;
  std::vector<std::thread> writers;
  for (int t = 0; t < 3; ++t)
    writers.emplace_back([&] {
      while (!done) hdf5({"another"});
    });
  const std::string bytes = hdf5({"one"});
  for (int i = 0; i < 100; ++i) EXPECT_THAT(read(bytes), ElementsAre(1, 2, 4));
  done = true;
  for (std::thread& writer : writers) writer.join();
}

// Damage at any place is an InputError, or another field of three finite numbers.
TEST(PointValues, SurviveACutAnywhere) {
  const std::string whole = npy<double>("<f8", "3,", {1, 2, 4});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(refusal(whole.substr(0, size)), "none") << size;
}

}  // namespace
}  // namespace salbench
