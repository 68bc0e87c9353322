// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of every type that a file of another program may hold are read exactly, or refused.
#include <cmath>
#include <cstdint>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "io/file.h"
#include "io/hdf5_file.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;
using testing::VariantWith;

// A file with a data set "x" of that type, and an attribute "x" of its first number.
class Hdf5Types : public testing::Test {
 protected:
  template <class Number>
  std::filesystem::path write(hid_t stored, hid_t given, const std::vector<Number>& numbers,
                              std::vector<hsize_t> shape = {}) const {
    if (shape.empty()) shape = {numbers.size()};
    const std::filesystem::path path = folder_ / "foreign.h5";
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t set = H5Dcreate2(file, "x", stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Dwrite(set, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()), 0);
    const hid_t one = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(file, "x", stored, one, H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Awrite(attribute, given, numbers.data()), 0);
    EXPECT_GE(H5Aclose(attribute), 0);
    EXPECT_GE(H5Sclose(one), 0);
    EXPECT_GE(H5Dclose(set), 0);
    EXPECT_GE(H5Sclose(space), 0);
    EXPECT_GE(H5Fclose(file), 0);
    return path;
  }
  static ArrayValues values_of(const std::filesystem::path& path) { return Hdf5File(path).read("x").values; }
  static AttributeValue attribute_of(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    return hdf5_content(std::as_bytes(std::span(bytes)), "x.h5").attributes.at(0).second;
  }
  static std::string refusal(const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
};

TEST_F(Hdf5Types, RealsOfAtMost64BitsAreExact) {
  const double third = 1.0 / 3;
  for (const hid_t stored : {H5T_IEEE_F64LE, H5T_IEEE_F64BE})
    EXPECT_THAT(values_of(write<double>(stored, H5T_NATIVE_DOUBLE, {third, -1e308, 5e-324})),
                VariantWith<std::vector<double>>(ElementsAre(third, -1e308, 5e-324)));
  for (const hid_t stored : {H5T_IEEE_F32LE, H5T_IEEE_F32BE})
    EXPECT_THAT(values_of(write<float>(stored, H5T_NATIVE_FLOAT, {0.1F, 1e-45F})),
                VariantWith<std::vector<float>>(ElementsAre(0.1F, 1e-45F)));

  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  ASSERT_GE(H5Tset_fields(half, 15, 10, 5, 0, 10), 0);
  ASSERT_GE(H5Tset_size(half, 2), 0);
  ASSERT_GE(H5Tset_ebias(half, 15), 0);
  EXPECT_THAT(values_of(write<float>(half, H5T_NATIVE_FLOAT, {0.5F, -65504})),
              VariantWith<std::vector<float>>(ElementsAre(0.5F, -65504)));
  EXPECT_EQ(attribute_of(write<float>(half, H5T_NATIVE_FLOAT, {0.5F})), AttributeValue(0.5));

  // 32 bits with a mantissa wider than a float's.
  const hid_t wide = H5Tcopy(H5T_IEEE_F32LE);
  ASSERT_GE(H5Tset_fields(wide, 31, 26, 5, 0, 26), 0);
  ASSERT_GE(H5Tset_ebias(wide, 15), 0);
  EXPECT_THAT(values_of(write<double>(wide, H5T_NATIVE_DOUBLE, {1 + 0x1p-26})),
              VariantWith<std::vector<double>>(ElementsAre(1 + 0x1p-26)));
}

TEST_F(Hdf5Types, WiderRealsAreRefused) {
  const auto path = write<long double>(H5T_NATIVE_LDOUBLE, H5T_NATIVE_LDOUBLE, {1.0L / 3});
  EXPECT_THAT(refusal([&] { values_of(path); }),
              HasSubstr("data set \"x\": its numbers of 16 bytes are wider than float64 and int64"));
  EXPECT_THAT(refusal([&] { attribute_of(path); }), HasSubstr("x.h5"));
}

TEST_F(Hdf5Types, WholeNumbersAreExactOrRefused) {
  constexpr std::int64_t kBeyond = (1LL << 53) + 1;
  EXPECT_THAT(values_of(write<std::int8_t>(H5T_STD_I8LE, H5T_NATIVE_INT8, {-128, 127})),
              VariantWith<std::vector<std::int32_t>>(ElementsAre(-128, 127)));
  EXPECT_THAT(values_of(write<std::uint8_t>(H5T_STD_U8LE, H5T_NATIVE_UINT8, {255})),
              VariantWith<std::vector<std::uint8_t>>(ElementsAre(255)));
  EXPECT_THAT(values_of(write<std::uint16_t>(H5T_STD_U16BE, H5T_NATIVE_UINT16, {65535})),
              VariantWith<std::vector<std::int32_t>>(ElementsAre(65535)));
  EXPECT_THAT(values_of(write<std::uint32_t>(H5T_STD_U32LE, H5T_NATIVE_UINT32, {4294967295U})),
              VariantWith<std::vector<std::int64_t>>(ElementsAre(4294967295LL)));
  EXPECT_THAT(values_of(write<std::int64_t>(H5T_STD_I64BE, H5T_NATIVE_INT64, {kBeyond})),
              VariantWith<std::vector<std::int64_t>>(ElementsAre(kBeyond)));
  const auto largest = write<std::uint64_t>(H5T_STD_U64LE, H5T_NATIVE_UINT64, {std::uint64_t{1} << 63U});
  EXPECT_THAT(refusal([&] { values_of(largest); }), HasSubstr("beyond the range of their type"));
  EXPECT_THAT(refusal([&] { attribute_of(largest); }), HasSubstr("x.h5"));
}

TEST_F(Hdf5Types, ValuesPerPointAreDoublesOrRefused) {
  const auto field_of = [&](const std::filesystem::path& path) { return read_hdf5_values(path, "out.h5"); };
  EXPECT_THAT(field_of(write<std::int64_t>(H5T_STD_I64LE, H5T_NATIVE_INT64, {-(1LL << 53), 1LL << 53})),
              ElementsAre(-0x1p53, 0x1p53));
  const auto beyond = write<std::int64_t>(H5T_STD_I64LE, H5T_NATIVE_INT64, {1, (1LL << 53) + 1});
  EXPECT_EQ(refusal([&] { field_of(beyond); }),
            "out.h5: data set \"x\": it holds 9007199254740993: whole numbers beyond 2^53 cannot be used, "
            "scale them");
  const std::vector<double> six = {1, 2, 3, 4, 5, 6};
  for (const std::vector<hsize_t>& shape : {std::vector<hsize_t>{6}, {6, 1}, {1, 6}, {1, 6, 1}})
    EXPECT_EQ(field_of(write(H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, six, shape)), six);
  const auto pairs = write(H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, six, {3, 2});
  EXPECT_EQ(refusal([&] { field_of(pairs); }),
            "out.h5: data set \"x\": its shape is (3, 2), expected one value per point");
}

}  // namespace
}  // namespace salbench
