// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "cache/layout.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::atomic<bool> kGoOn = false;
NoProgress progress;

class VerifyTest : public testing::Test {
 protected:
  static Recipe recipe(int k) {
    return {"fpfh",
            2,
            "k: " + std::to_string(k) + "\n",
            "2016/52",
            {{"mesh: of clay", {1, 2}}, {"normals", {3, 4}}}};
  }
  void SetUp() override {
    FolderStore store(folder_.path(), Access::read_write);
    for (int k = 0; k < 3; ++k) save(store, recipe(k), k);
  }
  static void save(FolderStore& store, const Recipe& what, double value) {
    store.save(what, "field", {{"saliency", {2}, std::vector<double>{value, 1}, "1", "two values"}},
               {.item = "52", .seconds = 0.5, .attributes = {}});
  }
  fs::path file(int k) const {
    return *FolderStore(folder_.path(), Access::read_only).path("fpfh", key_of(recipe(k)));
  }
  static void rewrite(const fs::path& path, const Bytes& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  // Stores `bytes` under a name whose size and checksum are theirs: only what they say can be wrong.
  void disguise(int k, const Bytes& bytes, const ArtefactName& as) const {
    ArtefactName name = as;
    name.checksum = checksum(bytes);
    name.size = bytes.size();
    fs::remove(file(k));
    fs::create_directories(folder_ / shard_of("fpfh", name.key));
    rewrite(folder_ / shard_of("fpfh", name.key) / name.text(), bytes);
  }
  ArtefactName name(int k) const { return *parse_artefact_name(file(k).filename().string()); }
  Verification verify() const { return verify_cache(folder_.path(), kGoOn, progress); }
  // The one fault there is.
  std::string fault() const {
    const Verification result = verify();
    EXPECT_THAT(result.faults, SizeIs(1));
    return result.faults.empty() ? "" : result.faults.front().what;
  }

  TemporaryFolder folder_;
};

TEST_F(VerifyTest, ASoundCacheIsCountedAndHasNoFault) {
  folder_.write("fpfh/readme.txt", "not an artefact");
  folder_.write("loose", "nor this");
  folder_.write("damaged/" + name(0).text(), "moved aside before");
  const Verification result = verify();
  EXPECT_EQ(result.artefacts, 3U);
  EXPECT_EQ(result.bytes, fs::file_size(file(0)) + fs::file_size(file(1)) + fs::file_size(file(2)));
  EXPECT_EQ(result.others, 2U);
  EXPECT_THAT(result.faults, IsEmpty());
}

TEST_F(VerifyTest, AttributesGiveBackTheRecipe) {
  const auto bytes = *read_bytes(file(1));
  const auto read = recipe_from(hdf5_content(bytes, "artefact").attributes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->inputs, recipe(1).inputs);
  EXPECT_EQ(key_of(*read), key_of(recipe(1)));
  EXPECT_FALSE(recipe_from({{"stage", "fpfh"}}));
}

TEST_F(VerifyTest, NamesEachBadArtefactAndMovesNone) {
  const fs::path short_one = file(0), flipped_one = file(2);
  fs::resize_file(short_one, fs::file_size(short_one) - 1);
  Bytes bytes = *read_bytes(flipped_one);
  bytes[bytes.size() / 2] ^= std::byte{1};
  rewrite(flipped_one, bytes);
  const Verification result = verify();
  EXPECT_EQ(result.artefacts, 3U);
  EXPECT_THAT(result.faults,
              testing::UnorderedElementsAre(
                  AllOf(Field(&Fault::file, short_one), Field(&Fault::what, HasSubstr("truncated: "))),
                  AllOf(Field(&Fault::file, flipped_one), Field(&Fault::what, HasSubstr("checksum")))));
  EXPECT_TRUE(fs::exists(short_one) && fs::exists(flipped_one));
}

TEST_F(VerifyTest, AFileThatIsNoHdf5IsNamedWhateverItsChecksum) {
  disguise(0, Bytes(100, std::byte{'x'}), name(0));
  EXPECT_THAT(fault(), HasSubstr("HDF5"));
  FolderStore store(folder_.path(), Access::read_write);
  EXPECT_FALSE(store.load("fpfh", key_of(recipe(0)))) << "a miss, not the end of the run";
  EXPECT_THAT(verify().faults, IsEmpty());
}

TEST_F(VerifyTest, AnArtefactUnderTheContentOfAnotherIsNamed) {
  ArtefactName wrong = name(0);
  wrong.content = name(1).content;
  disguise(0, *read_bytes(file(0)), wrong);
  EXPECT_THAT(fault(), HasSubstr("content does not match its name"));
}

TEST_F(VerifyTest, AnArtefactUnderTheKeyOfAnotherIsNamedAndNotUsed) {
  ArtefactName wrong = name(0);
  wrong.key = key_of(recipe(7));
  disguise(0, *read_bytes(file(0)), wrong);
  EXPECT_THAT(fault(), HasSubstr("its key is not that of its recipe"));
  EXPECT_FALSE(FolderStore(folder_.path(), Access::read_only).load("fpfh", wrong.key));
}

TEST_F(VerifyTest, AnArtefactInTheWrongFolderIsNamed) {
  const fs::path from = file(0), other_shard = folder_ / "fpfh" / "zz", other_stage = folder_ / "map.PS";
  fs::create_directories(other_shard);
  fs::rename(from, other_shard / from.filename());
  EXPECT_THAT(fault(), HasSubstr("folder of another key"));
  fs::create_directories(other_stage / from.parent_path().filename());
  fs::rename(other_shard / from.filename(), other_stage / from.parent_path().filename() / from.filename());
  EXPECT_THAT(fault(), HasSubstr("stage fpfh"));
}

TEST_F(VerifyTest, TwoContentsUnderOneKeyAreNamed) {
  FolderStore store(folder_.path(), Access::read_write);
  save(store, recipe(0), 99);
  EXPECT_THAT(fault(), HasSubstr("another content"));
}

// Two processes may compute the same job at the same time: the files differ in the seconds they note.
TEST_F(VerifyTest, TheSameContentTwiceUnderOneKeyIsSound) {
  FolderStore store(folder_.path(), Access::read_write);
  store.save(recipe(0), "field", {{"saliency", {2}, std::vector<double>{0, 1}, "1", "two values"}},
             {.item = "52", .seconds = 0.75, .attributes = {}});
  const Verification result = verify();
  EXPECT_EQ(result.artefacts, 4U);
  EXPECT_THAT(result.faults, IsEmpty());
}

TEST_F(VerifyTest, AFolderThatIsNoCacheIsRefused) {
  TemporaryFolder other;
  EXPECT_THROW(verify_cache(other.path(), kGoOn, progress), StorageError);
  EXPECT_THROW(verify_cache(other / "missing", kGoOn, progress), StorageError);
  other.write("CACHEDIR.TAG", "Signature: 8a477f597d28d172789f06886806bc55\n# of another program\n");
  EXPECT_THROW(verify_cache(other.path(), kGoOn, progress), StorageError);
}

// More than one process checks, as many as there are cores: each takes a part.
TEST_F(VerifyTest, ManyArtefactsAreReportedInTheOrderOfTheirFiles) {
  constexpr int kArtefacts = 1500;
  {
    FolderStore store(folder_.path(), Access::read_write);
    for (int k = 3; k < kArtefacts; ++k) save(store, recipe(k), k);
  }
  const std::vector<ArtefactFile> files = artefacts_of(folder_.path());
  ASSERT_THAT(files, SizeIs(kArtefacts));
  std::vector<fs::path> cut;
  for (std::size_t i = 0; i < files.size(); i += 7) {
    fs::resize_file(files[i].path, files[i].name.size - 1);
    cut.push_back(files[i].path);
  }
  struct Count final : Progress {
    void begin(const std::string&, std::size_t items, std::function<std::string()>) override {
      expected = items;
    }
    void item_done() override { ++done; }
    void end() override {}
    std::size_t expected = 0;
    std::atomic<std::size_t> done = 0;
  } count;
  const Verification result = verify_cache(folder_.path(), kGoOn, count);
  std::vector<fs::path> named;
  for (const Fault& fault : result.faults) named.push_back(fault.file);
  EXPECT_EQ(named, cut);
  EXPECT_EQ(result.artefacts, kArtefacts);
  EXPECT_EQ(count.expected, kArtefacts);
  EXPECT_EQ(count.done, kArtefacts);
}

TEST_F(VerifyTest, StopsWhenAsked) {
  const std::atomic<bool> stop = true;
  EXPECT_EQ(verify_cache(folder_.path(), stop, progress).artefacts, 0U);
}

TEST_F(VerifyTest, AReadOnlyStoreLeavesADamagedArtefactWhereItIs) {
  const fs::path path = file(0);
  Bytes bytes = *read_bytes(path);
  bytes.back() ^= std::byte{1};
  rewrite(path, bytes);
  testing::internal::CaptureStdout();
  EXPECT_FALSE(FolderStore(folder_.path(), Access::read_only).load("fpfh", key_of(recipe(0))));
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr(path.filename().string()), HasSubstr("checksum mismatch"),
                    HasSubstr("a run will compute it again")));
  EXPECT_TRUE(fs::exists(path));
  EXPECT_FALSE(fs::exists(folder_ / "damaged"));
}

}  // namespace
}  // namespace salbench
