// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files of other programs as saliency maps, and a library that has to be called by one thread at a time.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::SizeIs;

// A file with the maps of both meshes; then, as `further` lines of Python have it, `file` and `map` "1" may
// change.
fs::path maps_by_h5py(const Workspace& toy, const std::string& further) {
  const fs::path path = toy / "foreign.h5";
  const std::string script =
      "import h5py, numpy, sys\n"
      "with h5py.File(sys.argv[1], 'w') as file:\n"
      "  values = numpy.arange(162.)\n"
      "  map = file['1'] = values\n  map = file['1']\n  file['2'] = values % 7\n" +
      further;
  const Outcome made = run_process({kPython, toy.write("make.py", script).string(), path.string()});
  EXPECT_EQ(made.status, 0) << made.err;
  return path;
}

Outcome score_maps(const Workspace& toy, const fs::path& maps) {
  return toy.salbench("run", {"--maps", maps.string(), "--name", "OWN"});
}

// Before, 4096 numbers were read into the place of one.
TEST(ForeignHdf5, WhatStandsBesideTheMapsIsNotRead) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(score_maps(toy, maps_by_h5py(toy, "")).status, 0);
  const std::string results = toy.results();
  const std::string beside[] = {
      "  map.attrs['many'] = numpy.ones(4096)\n",
      "  map.attrs['unit'] = numpy.ones(4096)\n  map.attrs['description'] = 7\n",
      "  map.attrs['texts'] = numpy.array([b'one', b'two'])\n",
      "  map.attrs['texts'] = numpy.array(['one', 'two'], dtype=h5py.string_dtype())\n",
      "  map.attrs['record'] = numpy.zeros(500, dtype=[('a', 'i4'), ('b', 'f8')])\n",
      "  map.attrs['enum'] = numpy.array([True, False])\n",
      "  map.attrs.create('none', h5py.Empty('f8'))\n  map.attrs['reference'] = map.ref\n",
      "  file.attrs['many'] = numpy.ones(4096)\n  file.create_group('g').attrs['many'] = numpy.ones(4096)\n",
      "  file['3'] = 'a text'\n  file['4'] = numpy.zeros(2, dtype=[('a', 'i4')])\n"
      "  file['5'] = h5py.Empty('f8')\n",
      "  file['g/up'] = file['/']\n  file['soft'] = h5py.SoftLink('/nowhere')\n"
      "  file['out'] = h5py.ExternalLink('/dev/zero', '/')\n"};
  for (const std::string& further : beside) {
    const Outcome run = score_maps(toy, maps_by_h5py(toy, further));
    EXPECT_EQ(run.status, 0) << further << run.err;
    EXPECT_EQ(toy.results(), results) << further;
  }
}

TEST(ForeignHdf5, AMapThatCannotBeHadIsItsItemsFailure) {
  const Workspace toy(kMeshesOnly);
  const fs::path pipe = toy / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  struct Bad {
    std::string made_by, said;
  };
  const Bad all[] = {
      {"file.create_dataset('1', shape=(1 << 40,), dtype='f8', chunks=(16,))",
       "it claims 8796093022208 bytes"},
      {"file.create_dataset('1', shape=(1 << 40,), dtype='f4')", "and 0 are stored"},
      {"file.create_dataset('1', shape=(1 << 32, 1 << 32), dtype='f8', chunks=(1, 1))",
       "bytes of values, and 0 are stored"},
      {"file.create_dataset('1', shape=(1,) * 20, dtype='f8')", "20 dimensions"},
      {"file.create_dataset('1', shape=(162,), dtype='f8', external=[('" + pipe.string() + "', 0, 1296)])",
       "in other files"},
      {"file.create_dataset('1', data=h5py.Empty('f8'))", "no values"},
      {"file.create_dataset('1', data=numpy.full(162, 1 << 63, dtype='u8'))", "beyond 2^53"},
      {"file['1'] = numpy.full(162, (1 << 53) + 1)", "whole numbers beyond 2^53"},
      {"file['1'] = values.astype('longdouble')", "wider than float64"},
      {"file['1'] = values.reshape(81, 2)", "its shape is (81, 2), expected one value per point"}};
  for (const Bad& bad : all) {
    const Outcome run = score_maps(toy, maps_by_h5py(toy, "  del file['1']\n  " + bad.made_by + "\n"));
    EXPECT_EQ(run.status, 1) << bad.made_by << run.err;
    EXPECT_THAT(lines_with(run.err, "error: 1: "), AllOf(SizeIs(1), Each(HasSubstr(bad.said)))) << run.err;
    EXPECT_THAT(lines_with(toy.results(), ",OWN,"), SizeIs(1)) << "the other map is scored";
  }
}

TEST(ForeignHdf5, FilesThatAreNoneAreRefused) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(::mkfifo((toy / "pipe").c_str(), 0600), 0);
  const std::string deep =
      "  group = file\n"
      "  for n in range(20000):\n    group = group.create_group('g')\n";
  const fs::path maps = maps_by_h5py(toy, deep);
  fs::copy_file(maps, toy / "cut.h5");
  fs::resize_file(toy / "cut.h5", fs::file_size(maps) / 2);
  for (const fs::path& path : {toy / "pipe", toy / "cut.h5", maps}) {
    const Outcome run = score_maps(toy, path);  // a pipe without a writer would never be opened
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_THAT(lines_with(run.err, ""), AllOf(SizeIs(1), Each(HasSubstr(path.string())))) << run.err;
  }
}

TEST(Hdf5Library, IsCalledByOneThreadAtATimeWhereItIsNotThreadSafe) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  toy.forget_everything();
  std::vector<std::string> words = {"/usr/bin/env", "LD_PRELOAD=" SALBENCH_WATCH_HDF5,
                                    "ASAN_OPTIONS=verify_asan_link_order=0"};
  for (const std::string& word : toy.command("run", {"--threads", "4"})) words.push_back(word);
  const Outcome run = run_process(words);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(toy.results(), results);
}

}  // namespace
}  // namespace salbench
