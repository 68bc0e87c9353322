// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <fmt/format.h>

#include "cache/folder_store.h"
#include "cache/layout.h"
#include "io/file.h"
#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::Field;

const std::atomic<bool> kGoOn = false;
NoProgress progress;

class VerifyTest : public testing::Test {
 protected:
  static Recipe recipe(int k) {
    return {"fpfh", 2, "k: " + std::to_string(k) + "\n", "2016/52", {{"mesh: of clay", {1, 2}}}};
  }
  void SetUp() override {
    FolderStore store(folder_.path(), Access::read_write);
    for (int k = 0; k < 3; ++k) save(store, recipe(k), k, std::to_string(k));
    store.flush("52");
  }
  static void save(FolderStore& store, const Recipe& what, double value, const std::string& item,
                   double seconds = 0.5) {
    store.save("52", artefact_of(what, "field",
                                 {{"saliency", {2}, std::vector<double>{value, 1}, "1", "two values"}},
                                 {item, seconds}));
  }
  fs::path file() const { return list_segments(folder_.path()).at(0); }
  Verification verify() const { return verify_cache(folder_.path(), kGoOn, progress); }
  // The only fault.
  std::string fault() const {
    const Verification result = verify();
    EXPECT_THAT(result.faults, SizeIs(1));
    return result.faults.empty() ? "" : result.faults.front().what;
  }

  TemporaryFolder folder_;
};

TEST_F(VerifyTest, ASoundCacheIsCountedAndHasNoFault) {
  folder_.write("00/readme.txt", "not an artefact");
  folder_.write("loose", "nor this");
  folder_.write("00/" + file().filename().string() + ".damaged", "renamed before");
  const Verification result = verify();
  EXPECT_EQ(result.artefacts, 3U);
  EXPECT_EQ(result.bytes, fs::file_size(file()));
  EXPECT_EQ(result.others, 2U);
  EXPECT_THAT(result.faults, IsEmpty());
}

TEST_F(VerifyTest, NamesEachBadArtefactAndChangesNothing) {
  damage(folder_.path(), "fpfh", "0");
  damage(folder_.path(), "fpfh", "2");
  const auto before = read_bytes(file());
  const Verification result = verify();
  EXPECT_EQ(result.artefacts, 3U);
  EXPECT_THAT(
      result.faults,
      ElementsAre(AllOf(Field(&Fault::file, file()), Field(&Fault::what, HasSubstr("fpfh of 0: checksum"))),
                  AllOf(Field(&Fault::file, file()), Field(&Fault::what, HasSubstr("fpfh of 2: checksum")))));
  EXPECT_EQ(read_bytes(file()), before);
}

// A run after a verify that found damage finds the same damage.
TEST_F(VerifyTest, ARunAfterItReadsEverySegment) {
  damage_unseen(folder_.path(), "fpfh", "0");
  EXPECT_THAT(verify().faults, SizeIs(1));
  EXPECT_FALSE(FolderStore(folder_.path(), Access::read_write).find(key_of(recipe(1))));
  EXPECT_THAT(verify().faults, IsEmpty());
}

// The last is read by h5py, but never by the program.
TEST_F(VerifyTest, AFileThatIsDamagedElsewhereIsNamed) {
  const auto size = fs::file_size(file());
  for (const auto& [length, what] : {std::pair(size - 1, "truncated"), {size + 1, "too long"}}) {
    fs::resize_file(file(), length);
    EXPECT_THAT(fault(),
                AllOf(StartsWith(what), HasSubstr(fmt::format("{} bytes, expected {}", length, size))));
  }
  fs::resize_file(file(), size);
  for (const auto& [at, what] : {std::pair(size - 1, "HDF5 part"), {100, "checksum mismatch in its table"}}) {
    flip_byte(file(), at);
    EXPECT_THAT(fault(), HasSubstr(what));
    flip_byte(file(), at);
  }
  fs::rename(file(), file().parent_path() / SegmentName{"52", 7}.text());
  EXPECT_THAT(fault(), HasSubstr("not the file of this name"));
}

TEST_F(VerifyTest, TwoContentsUnderOneKeyAreNamed) {
  FolderStore store(folder_.path(), Access::read_write);
  save(store, recipe(0), 99, "0");
  store.flush("52");
  EXPECT_THAT(fault(), HasSubstr("another content"));
}

// Two processes may compute the same job concurrently: the files differ in the seconds they record.
TEST_F(VerifyTest, TheSameContentTwiceUnderOneKeyIsSound) {
  FolderStore store(folder_.path(), Access::read_write);
  save(store, recipe(0), 0, "0", 0.75);
  store.flush("52");
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

// Several threads check, one per core, each a part.
TEST_F(VerifyTest, ManyFilesAreReportedInTheirOrder) {
  constexpr int kFamilies = 300;
  {
    FolderStore store(folder_.path(), Access::read_write);
    for (int k = 3; k < kFamilies; ++k) {
      store.save(
          "family" + std::to_string(k),
          artefact_of(recipe(k), "field", {{"saliency", {1}, std::vector<double>{1}, "1", ""}}, {"x"}));
      store.flush("family" + std::to_string(k));
    }
  }
  const std::vector<fs::path> files = list_segments(folder_.path());
  std::vector<fs::path> cut;
  for (std::size_t i = 0; i < files.size(); i += 7) {
    fs::resize_file(files[i], fs::file_size(files[i]) - 1);
    cut.push_back(files[i]);
  }
  CountedProgress count;
  const Verification result = verify_cache(folder_.path(), kGoOn, count);
  std::vector<fs::path> named;
  for (const Fault& fault : result.faults)
    if (named.empty() || named.back() != fault.file) named.push_back(fault.file);
  std::ranges::sort(cut);
  EXPECT_EQ(named, cut);
  EXPECT_EQ(result.artefacts, kFamilies);
  EXPECT_EQ(count.expected, files.size());
  EXPECT_EQ(count.done, files.size());
}

TEST_F(VerifyTest, StopsWhenAsked) {
  const std::atomic<bool> stop = true;
  EXPECT_EQ(verify_cache(folder_.path(), stop, progress).artefacts, 0U);
}

TEST_F(VerifyTest, AReadOnlyStoreLeavesADamagedFileWhereItIs) {
  flip_byte(file(), 100);
  const fs::path path = file();
  testing::internal::CaptureStdout();
  EXPECT_FALSE(FolderStore(folder_.path(), Access::read_only).load(key_of(recipe(0))));
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr(path.filename().string()), HasSubstr("checksum mismatch"),
                    HasSubstr("a run will compute what was in it again")));
  EXPECT_TRUE(fs::exists(path));
  EXPECT_THAT(list_damaged(folder_.path()), IsEmpty());
}

}  // namespace
}  // namespace salbench
