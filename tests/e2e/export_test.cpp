// SPDX-License-Identifier: GPL-3.0-or-later
// What `salbench export` writes: it says what the cache says, and other programs read it.
#include <algorithm>
#include <csignal>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/small_disk.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/exported_file.h"
#include "tests/support/job_counts.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

Outcome compared(const Workspace& toy, const fs::path& file) {
  return run_process({kPython, SALBENCH_COMPARE_EXPORT, file.string(), toy.cache().string()});
}

TEST(Export, OfFiveItemsSaysWhatTheCacheSaysToTheBit) {
  const Workspace toy;
  write_toy_item(toy.data(), "3", shapes::bumpy_sphere(1));  // equal meshes would share artefacts
  write_toy_item(toy.data(), "4", shapes::bumpy_sphere(1, 0.3));
  write_toy_item(toy.data(), "5", shapes::bumpy_sphere(3, 0.4));  // descriptors large enough to be packed
  const Outcome ended = toy.salbench("export", {"--to", (toy / "new folder" / "toy.h5").string()});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Outcome same = compared(toy, toy / "new folder" / "toy.h5");
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_THAT(same.out,
              testing::MatchesRegex(fmt::format("[0-9]+ data sets, [1-9][0-9]* of them packed, {} scores\n",
                                                JobCounts(kToyConfig, 5).of_kind("scores"))));
}

// The attribute of an object of an export, by h5py.
std::string attribute(const fs::path& file, const std::string& object, const std::string& name) {
  const Outcome read =
      run_process({kPython, "-c",
                   "import h5py, sys; a = h5py.File(sys.argv[1])[sys.argv[2]].attrs[sys.argv[3]]; "
                   "sys.stdout.write(a.decode() if isinstance(a, bytes) else a)",
                   file.string(), object, name});
  EXPECT_EQ(read.status, 0) << read.err;
  return read.out;
}

TEST(Export, TellsConfigurationAndVersions) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "toy.h5").string()}).status, 0);
  const auto root = [&](const char* name) { return attribute(toy / "toy.h5", "/", name); };
  EXPECT_THAT(root("program"), testing::StartsWith("salbench "));
  EXPECT_THAT(root("configuration"), AllOf(HasSubstr("seed: 2016"), HasSubstr("scans: false")));
  EXPECT_THAT(root("stage_versions"), AllOf(HasSubstr("fpfh: "), HasSubstr("map.PS: ")));
  EXPECT_EQ(root("protocol"), "published");
  EXPECT_EQ(attribute(toy / "toy.h5", "/1", "dataset"), "meshes");
  toy.configure(root("configuration"));  // and can be run again as it stands there
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
}

TEST(Export, TellsWhatMapsWereMatchedTo) {
  const Workspace toy(kMeshesOnly);
  const auto told = [&](std::vector<std::string> further) {
    further.insert(further.end(), {"--to", (toy / "toy.h5").string()});
    const Outcome ended = toy.salbench("export", further);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return attribute(toy / "toy.h5", "/", "reference");
  };
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string table = (toy.out() / "mean_histograms_meshes.csv").string();
  const std::vector<std::pair<std::vector<std::string>, const char*>> cases = {
      {{}, "mean over the items of the export"},
      {{"--items", "1-2"}, "mean over the items of the export"},
      {{"--items", "2"}, "mean over all items of the data set or split"},
      {{"--items", "2", "--stage", "map"}, "mean over all items of the data set or split"},
      {{"--items", "2", "--reference", "items"}, "mean over the items of the export"},
      {{"--items", "2", "--reference", table}, "given by --reference"}};
  for (const auto& [further, expected] : cases)
    EXPECT_EQ(told(further), expected) << fmt::format("{}", fmt::join(further, " "));
  for (const char* part : {"Distributions", "RawData"}) fs::remove_all(toy.data() / part);
  EXPECT_EQ(told({}), "none");
}

TEST(Export, ChoosesItemsAndStages) {
  const Workspace toy(kMeshesOnly);
  const Outcome ended =
      toy.salbench("export", {"--to", (toy / "toy.h5").string(), "--items", "2", "--stage", "normals, map"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ExportedFile(toy / "toy.h5").arrays(),
              testing::ElementsAre("2/map.PS/saliency", "2/map.RS/saliency", "2/normals/normals"));
}

TEST(Export, TakesPicturesWhereItIsAskedForThemAndHasThemFromThenOn) {
  const Workspace toy;
  const auto pictures = [&](std::vector<std::string> further) {
    further.insert(further.end(), {"--to", (toy / "toy.h5").string()});
    EXPECT_EQ(toy.salbench("export", further).status, 0);
    return std::ranges::count_if(ExportedFile(toy / "toy.h5").arrays(), [](const std::string& name) {
      return name.ends_with("/picture/primitive");
    });
  };
  EXPECT_EQ(pictures({}), 0);
  EXPECT_EQ(pictures({"--pictures", "--items", "2"}), 13);
  EXPECT_EQ(pictures({}), 13);
  const ExportedFile file(toy / "toy.h5");
  EXPECT_EQ(file.read("2/picture/primitive").shape, (std::vector<std::size_t>{400, 400}));
  EXPECT_EQ(file.read("2_5/picture/weights").shape, (std::vector<std::size_t>{400, 400, 3}));
}

TEST(Export, TwiceGivesTheSameBytes) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "a.h5").string()}).status, 0);
  toy.forget_everything();
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "b.h5").string(), "--threads", "1"}).status, 0);
  EXPECT_EQ(read_bytes(toy / "a.h5"), read_bytes(toy / "b.h5"));
}

TEST(Export, IsReadByTheExampleCopiedAndLinked) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "copy.h5").string()}).status, 0);
  ASSERT_EQ(toy.salbench("export", {"--link", "--to", (toy / "links" / "toy.h5").string()}).status, 0);
  EXPECT_LT(fs::file_size(toy / "links" / "toy.h5"), fs::file_size(toy / "copy.h5") / 2);
  const Outcome copy = run_process({kPython, SALBENCH_READ_EXPORT, (toy / "copy.h5").string()});
  const Outcome linked = run_process({kPython, SALBENCH_READ_EXPORT, (toy / "links" / "toy.h5").string()});
  ASSERT_EQ(copy.status, 0) << copy.err;
  ASSERT_EQ(linked.status, 0) << linked.err;
  EXPECT_EQ(linked.out, copy.out);

  const ExportedFile exported(toy / "copy.h5");
  double at_picks = 0;
  for (const std::string item : {"1", "2"}) {
    const auto map = std::get<std::vector<double>>(exported.read(item + "/map.PS/saliency").values);
    auto picks = std::get<std::vector<std::int32_t>>(exported.read(item + "/ground_truth/picks").values);
    std::ranges::sort(picks);
    picks.erase(std::ranges::unique(picks).begin(), picks.end());
    double sum = 0;
    for (const std::int32_t point : picks) sum += map[static_cast<std::size_t>(point)];
    at_picks += sum / static_cast<double>(picks.size()) / 2;
  }
  EXPECT_THAT(lines_with(copy.out, "meshes"),
              testing::Contains(testing::ContainsRegex(fmt::format("PS +{:.4f}", at_picks))))
      << copy.out;
}

TEST(Export, ShapesHaveTheValuesOfTheExport) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("export", {"--format", "ply", "--to", (toy / "shapes").string()}).status, 0);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "toy.h5").string()}).status, 0);
  const Outcome read =
      run_process({kPython, SALBENCH_READ_SHAPES, (toy / "toy.h5").string(), (toy / "shapes").string()});
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read.out, fmt::format("ok: {} items\n", JobCounts().shapes()));
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const FolderEntry& entry : list_folder(folder)) files.push_back(entry.path);
  return files;
}

TEST(Export, KilledNothingHasItsNameAndThePartIsKnownToBeAbandoned) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  fs::create_directories(toy / "exports");
  // All is in the cache: the first rename is that of the export.
  const Outcome killed = run_process(with_signal_at_rename(
      toy.command("export", {"--to", (toy / "exports/toy.h5").string()}), "1 before", SIGKILL));
  ASSERT_EQ(killed.status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(toy / "exports/toy.h5"));
  std::vector<fs::path> abandoned;
  visit_abandoned(toy / "exports", [&](const fs::path& file) { abandoned.push_back(file); });
  EXPECT_THAT(abandoned, testing::SizeIs(1));
  EXPECT_EQ(abandoned, files_in(toy / "exports"));
}

// Interrupted where another process has claimed what it is to compute again.
TEST(Export, InterruptedItLeavesNothing) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  fs::create_directories(toy / "exports");
  damage(toy.cache(), "scan", "2_5");
  const auto claim = toy.claim_family("2");
  Process process(toy.command("export", {"--to", (toy / "exports/toy.h5").string()}));
  ASSERT_TRUE(toy.tries_to_claim(process, 2));
  process.send(SIGINT);
  const Outcome ended = process.wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(lines_with(ended.err, " export "), testing::SizeIs(1));
  EXPECT_THAT(files_in(toy / "exports"), testing::IsEmpty());
}

// Whichever of its writes is the one that fails.
TEST(Export, AFullDiskIsOneErrorAndLeavesNothing) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("export", {"--to", (toy / "exports/whole.h5").string()}).status, 0);
  const std::uintmax_t blocks = fs::file_size(toy / "exports/whole.h5") / 1024;
  fs::remove(toy / "exports/whole.h5");
  for (std::uintmax_t limit = 1; limit < blocks; limit += 1 + blocks / 25) {
    std::string line = "ulimit -f " + std::to_string(limit) + "; exec";
    for (const std::string& word :
         toy.command("export", {"--to", (toy / "exports/toy.h5").string(), "--quiet"}))
      line += " '" + word + "'";
    const Outcome full = run_process({"/bin/bash", "-c", line});
    EXPECT_EQ(full.status, 3) << limit << full.err;
    EXPECT_THAT(lines_with(full.err, "error: "),
                AllOf(testing::SizeIs(1), testing::Each(HasSubstr("File too large"))))
        << limit << full.err;
    EXPECT_THAT(files_in(toy / "exports"), testing::IsEmpty());
  }
  const SmallDisk disk(toy / "exports", "size=100k");
  if (!disk.mounted()) GTEST_SKIP() << "mounting is not allowed here";
  const Outcome full = toy.salbench("export", {"--to", (toy / "exports/toy.h5").string(), "--quiet"});
  EXPECT_EQ(full.status, 3) << full.err;
  EXPECT_THAT(lines_with(full.err, "error: "),
              AllOf(testing::SizeIs(1), testing::Each(HasSubstr("No space left"))));
  EXPECT_THAT(files_in(toy / "exports"), testing::IsEmpty());
}

TEST(Export, TakesThePlaceOfNoFileOfTheUser) {
  const Workspace toy(kMeshesOnly);
  toy.write("thesis.txt", "years of work");
  const auto complaint = [&](const fs::path& to, const std::string& format) {
    const Outcome ended = toy.salbench("export", {"--to", to.string(), "--format", format});
    EXPECT_EQ(ended.status, 2) << ended.err;
    return ended.err;
  };
  EXPECT_THAT(complaint(toy / "thesis.txt", "h5"), HasSubstr("is there, and no HDF5 file; choose another"));
  EXPECT_THAT(complaint(toy.config(), "h5"), HasSubstr("no HDF5 file"));
  EXPECT_EQ(read_file(toy / "thesis.txt"), "years of work");
  toy.write("empty.h5", "");
  EXPECT_EQ(toy.salbench("export", {"--to", (toy / "empty.h5").string()}).status, 0);
  EXPECT_EQ(toy.salbench("export", {"--to", (toy / "empty.h5").string()}).status, 0) << "of an earlier call";
}

TEST(Export, TakesThePlaceOfNoShapeThatItReads) {
  const Workspace toy(kMeshesOnly);
  const Outcome shapes = toy.salbench("export", {"--to", (toy / "ply").string(), "--format", "ply"});
  ASSERT_EQ(shapes.status, 0) << shapes.err;
  const fs::path first = fs::directory_iterator(toy / "ply")->path();
  const std::string before = read_file(first);
  toy.configure("dataset: {scans: false, layout: folder, participants: simulated}\nmodels: {PS: }\n");
  for (const fs::path& to : {toy / "ply", toy / "ply/.", toy / "link"}) {
    fs::remove(toy / "link");
    fs::create_symlink(toy / "ply", toy / "link");
    const Outcome again =
        run_process({SALBENCH_PROGRAM, "export", toy.config().string(), "--data", (toy / "ply").string(),
                     "--cache", toy.cache().string(), "--to", to.string(), "--format", "ply"});
    EXPECT_EQ(again.status, 2) << again.err;
    EXPECT_THAT(again.err, HasSubstr("is read from there; choose another"));
  }
  EXPECT_EQ(read_file(first), before);
}

TEST(Export, TakesThePlaceOfNoMapThatItReads) {
  const Workspace toy(kMeshesOnly);
  const auto maps = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"--to", (toy / "maps").string(), "--format", "maps"};
    words.insert(words.end(), more.begin(), more.end());
    return toy.salbench("export", words);
  };
  ASSERT_EQ(maps({}).status, 0);
  fs::rename(toy / "maps/PS", toy / "maps/MINE");
  const std::string before = read_file(toy / "maps/MINE/1.val");
  const Outcome ended =
      maps({"--maps", (toy / "maps/MINE").string(), "--name", "MINE", "--stage", "matched"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("the maps of MINE are read from there; choose another"));
  EXPECT_EQ(read_file(toy / "maps/MINE/1.val"), before);
}

TEST(Export, SaysWhatItCannotDo) {
  const Workspace toy;
  const auto complaint = [&](const std::vector<std::string>& further) {
    std::vector<std::string> words = {"--to", (toy / "x").string()};
    words.insert(words.end(), further.begin(), further.end());
    const Outcome ended = toy.salbench("export", words);
    EXPECT_EQ(ended.status, 2);
    EXPECT_FALSE(fs::exists(toy / "x"));
    return ended.err;
  };
  EXPECT_THAT(complaint({"--stage", "maps"}), AllOf(HasSubstr("'maps'"), HasSubstr("map.PS")));
  EXPECT_THAT(complaint({"--format", "stl"}), AllOf(HasSubstr("stl"), HasSubstr("ply")));
  EXPECT_THAT(complaint({"--format", "ply", "--link"}), HasSubstr("--link"));
  write_toy_item(toy.data(), "1_3", shapes::bumpy_sphere(1));
  EXPECT_THAT(complaint({}), HasSubstr("'1_3'"));
  for (const std::string form : {"ply", "maps"})
    EXPECT_THAT(complaint({"--format", form}), HasSubstr("would be called '1_3'"));
}

}  // namespace
}  // namespace salbench
