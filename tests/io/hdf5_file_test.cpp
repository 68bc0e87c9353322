// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_file.h"

#include <fmt/format.h>

#include "io/hdf5/hdf5_writer.h"
#include "io/hdf5/packed_array.h"
#include "stages/core/rng.h"
#include "tests/support/h5py.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

Hdf5Content sample() {
  std::vector<float> descriptors(5000 * 33, 0.0F);
  Rng rng(1, "hdf5", "");
  for (std::size_t i = 0; i < descriptors.size(); i += 3) descriptors[i] = static_cast<float>(rng.uniform());
  return {
      {{"a", {2, 3}, std::vector<double>{1, 2, 3, 4, 5, kInfinity}, "m", "six"},
       {"deep/er", {2}, std::vector<std::int32_t>{-1, 7}, "1", ""},
       {"empty", {0, 3}, std::vector<double>{}, "m", "no rows"},
       {"fpfh", {5000, 33}, descriptors, "1", "compressed"},
       {"one", {}, std::vector<std::int64_t>{1LL << 40}, "1", "a scalar"}},
      {{"empty", std::string()}, {"item", std::string("ü 52")}, {"n", std::int64_t{-3}}, {"seconds", 0.25}}};
}

// Descriptions as in a damaged or hostile record.
TEST(PackedArray, PiecesThatDoNotGiveItsValuesAreRefused) {
  constexpr std::size_t kHuge = std::size_t{1} << 40U;
  const auto expect_refused = [](PackedArray packed, const auto& change) {
    change(packed);
    EXPECT_THROW(unpack(packed), InputError);
  };
  const PackedArray plain = pack(sample().arrays[0]), chunked = pack(sample().arrays[3]);
  expect_refused(plain, [](PackedArray& p) { p.pieces[0].pop_back(); });
  expect_refused(plain, [](PackedArray& p) { p.pieces.clear(); });
  expect_refused(plain, [](PackedArray& p) { p.type = 99; });
  expect_refused(plain, [](PackedArray& p) { p.shape.assign({kHuge, kHuge}); });
  expect_refused(plain, [](PackedArray& p) { p.shape.assign({std::size_t{1} << 60U}); });
  expect_refused(chunked, [](PackedArray& p) { p.pieces.pop_back(); });
  expect_refused(chunked, [](PackedArray& p) { p.pieces.push_back(p.pieces[0]); });
  expect_refused(chunked, [](PackedArray& p) { p.pieces[0][9] ^= std::byte{1}; });
  expect_refused(chunked, [](PackedArray& p) { p.chunk.assign({0, 33}); });
  expect_refused(chunked, [](PackedArray& p) { p.chunk.assign({kHuge, 33}); });
  expect_refused(chunked, [](PackedArray& p) { p.shape.assign({5000, 34}); });
}

TEST(Hdf5File, TwoThingsOfOneNameAreRefused) {
  const Array a{"a", {1}, std::vector<double>{1}, "1", ""};
  EXPECT_THROW(hdf5_image({{a, a}, {}}), std::runtime_error);
  const TemporaryFolder folder;
  Hdf5Writer writer(folder / "a.h5");
  writer.array(a);
  EXPECT_THROW(writer.array(a), StorageError);
  EXPECT_THROW(writer.link({"a", "other.h5", "/"}), StorageError);
}

// Written incrementally, with everything that an export contains.
void write_all(const std::filesystem::path& path) {
  Hdf5Writer writer(path);
  writer.attributes("/", {{"program", std::string("x")}});
  for (const Array& array : sample().arrays) writer.array({"52/all/" + array.name, pack(array)});
  writer.array({"52/fpfh/fpfh", {1, 2}, std::vector<float>{0.5F, 2}, "1", "rows"});
  writer.attributes("52/fpfh", {{"seconds", 0.5}});
  writer.attributes("52/empty", {{"why", std::string("nothing else implies it")}});
  writer.table(
      {"scores", {{"item", "n"}, {{"52", std::int64_t{7}}, {"", std::int64_t{-1}}}}, "one row per item"});
  writer.table({"no rows", {{"a", "b"}, {}}, ""});
  writer.table({"texts without a letter", {{"view"}, {{""}, {""}}}, ""});
  writer.link({"53/fpfh", "../cache/fpfh/a b.h5", "/"});
  writer.close();
}

TEST(Hdf5Writer, WritesWhatIsReadBackAndTheSameBytesAgain) {
  const TemporaryFolder folder;
  write_all(folder / "a.h5");
  write_all(folder / "b.h5");
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
  const Hdf5Content content = sample();
  double sum = 0;
  for (const float value : std::get<std::vector<float>>(content.arrays[3].values)) sum += double{value};
  EXPECT_EQ(shown_by_h5py(folder / "a.h5", "52"), fmt::format("all/a float64 (2, 3) inf m\n"
                                                              "all/deep/er int32 (2,) 6 1\n"
                                                              "all/empty float64 (0, 3) 0 m\n"
                                                              "all/fpfh float32 (5000, 33) {:.6g} 1\n"
                                                              "all/one int64 () 1.09951e+12 1\n"
                                                              "fpfh/fpfh float32 (1, 2) 2.5 1\n",
                                                              sum));
}

TEST(Hdf5Writer, ColumnsThatMixTypesAreRefused) {
  const TemporaryFolder folder;
  Hdf5Writer writer(folder / "a.h5");
  EXPECT_THROW(writer.table({"t", {{"a"}, {{"x"}, {0.5}}}, ""}), std::logic_error);
}

TEST(Hdf5Writer, WhereNothingCanBeWrittenIsAStorageError) {
  EXPECT_THROW(Hdf5Writer("/proc/nowhere/a.h5"), StorageError);
}

// As many inputs as in the mean over 4800 scans.
TEST(Hdf5File, EqualContentGivesEqualBytes) {
  EXPECT_EQ(hdf5_image(sample()), hdf5_image(sample()));
  const Hdf5Content of_a_mean{{}, {{"inputs", std::string(250'000, 'x')}}};
  EXPECT_EQ(hdf5_image(of_a_mean), hdf5_image(of_a_mean));
}

TEST(Hdf5File, CompressesDescriptors) { EXPECT_LT(hdf5_image(sample()).size(), 5000U * 33 * 4 * 6 / 10); }

// Sizes on both sides of a chunk's 4096 rows, for every type.
TEST(Hdf5File, ReadsBackPackedChunksOfEachType) {
  const auto values = []<class T>(std::size_t count) {
    std::vector<T> result(count);
    for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<T>(i * i % 251);
    return ArrayValues(result);
  };
  for (const std::size_t rows : {4095U, 4096U, 4097U, 8192U, 9000U}) {
    Hdf5Content content;
    const auto add = [&](const char* name, std::vector<std::size_t> shape, ArrayValues of_shape) {
      content.arrays.push_back({name, std::move(shape), std::move(of_shape), "1", "", true});
      EXPECT_EQ(pack(content.arrays.back()).pieces.size(), (rows + 4095) / 4096);
    };
    add("a", {rows, 2, 3}, values.operator()<double>(rows * 6));
    add("b", {rows, 5}, values.operator()<float>(rows * 5));
    add("c", {rows, 5}, values.operator()<std::int32_t>(rows * 5));
    add("d", {rows, 3}, values.operator()<std::int64_t>(rows * 3));
    add("e", {rows, 20}, values.operator()<std::uint8_t>(rows * 20));
    for (const Array& array : content.arrays) EXPECT_EQ(unpack(pack(array)).values, array.values);
  }
}

TEST(Hdf5File, ShapeAndValuesMustFit) {
  EXPECT_THROW(hdf5_image({{{"a", {3}, std::vector<double>{1}, "1", ""}}, {}}), std::logic_error);
}

TEST(Hdf5File, SeveralThreadsAtOnceEachGetTheirOwnFile) {
  same_in_threads_at_once([] {
    std::vector<Bytes> images;
    for (int i = 0; i < 300; ++i)
      images.push_back(
          hdf5_image({{{fmt::format("of {}", i), {1}, std::vector<std::int32_t>{i}, "1", ""}}, {}}));
    return images;
  });
}

}  // namespace
}  // namespace salbench
