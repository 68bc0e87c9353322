// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/folder_store.h"

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cache/artefact_name.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

class FolderStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "salbench-store-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  FolderStore open() const { return {folder_, Access::read_write}; }

  static Recipe recipe(const std::string& options = "k: 1\n") {
    return {"fpfh", 1, options, "", {{"mesh", {1, 2}}}};
  }
  static Arrays arrays(double value = 1) {
    return {{"saliency", {3}, std::vector<double>{value, 2, 3}, "1", "three values"}};
  }
  Digest save(FolderStore& store, const Recipe& what = recipe(), double value = 1) const {
    return store.save(what, "field", arrays(value), {.item = "52", .seconds = 0.5, .attributes = {}});
  }
  fs::path only_artefact() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.path().extension() == ".h5" && entry.path().string().find("damaged") == std::string::npos)
        found.push_back(entry.path());
    EXPECT_EQ(found.size(), 1U);
    return found.front();
  }

  fs::path folder_;
};

TEST_F(FolderStoreTest, FindsWhatItSavedAlsoWhenOpenedAgain) {
  FolderStore store = open();
  EXPECT_FALSE(store.find("fpfh", key_of(recipe())));
  const Digest content = save(store);
  EXPECT_EQ(store.find("fpfh", key_of(recipe())), content);
  FolderStore again(folder_, Access::read_only);
  EXPECT_EQ(again.find("fpfh", key_of(recipe())), content);
  EXPECT_TRUE(again.has_item("fpfh", "52"));
  EXPECT_FALSE(again.has_item("fpfh", "53"));
  EXPECT_FALSE(again.find("map.PS", key_of(recipe())));
  ASSERT_TRUE(again.load("fpfh", key_of(recipe())));
  EXPECT_EQ(again.load("fpfh", key_of(recipe()))->at(0).values, arrays()[0].values);
}

TEST_F(FolderStoreTest, SeesWhatAnotherProcessStored) {
  FolderStore mine = open(), theirs = open();
  const Digest content = save(theirs);
  EXPECT_FALSE(mine.find("fpfh", key_of(recipe())));
  EXPECT_EQ(mine.refresh_and_find("fpfh", key_of(recipe())), content);
}

TEST_F(FolderStoreTest, OnDemandItListsTheFolderOfAKeyAndNoOther) {
  std::vector<Recipe> recipes;
  {
    FolderStore store = open();
    for (int k = 0; k < 40; ++k) {
      recipes.push_back(recipe("k: " + std::to_string(k) + "\n"));
      save(store, recipes.back(), k);
    }
  }
  const FolderStore all(folder_, Access::read_only);
  FolderStore some(folder_, Access::on_demand);
  EXPECT_THAT(some.usage(), testing::IsEmpty());
  EXPECT_TRUE(some.find("fpfh", key_of(recipes[3])));
  std::size_t same_folder = 0;
  for (const Recipe& other : recipes)
    same_folder += key_of(other).hex().substr(0, 2) == key_of(recipes[3]).hex().substr(0, 2) ? 1U : 0U;
  ASSERT_LT(same_folder, recipes.size());
  ASSERT_THAT(some.usage(), testing::SizeIs(1));
  EXPECT_EQ(some.usage()[0].artefacts, same_folder);
  for (const Recipe& each : recipes) {
    EXPECT_EQ(some.find("fpfh", key_of(each)), all.find("fpfh", key_of(each)));
    EXPECT_EQ(some.path("fpfh", key_of(each)), all.path("fpfh", key_of(each)));
  }
  EXPECT_TRUE(some.load("fpfh", key_of(recipes[7])));
  EXPECT_FALSE(some.find("fpfh", {}));
  EXPECT_FALSE(some.find("map.PS", key_of(recipes[7])));
  EXPECT_TRUE(FolderStore(folder_, Access::on_demand).has_item("fpfh", "52"));
  EXPECT_FALSE(FolderStore(folder_, Access::on_demand).has_item("fpfh", "53"));
  EXPECT_FALSE(FolderStore(folder_, Access::on_demand).has_item("map.PS", "52"));
}

TEST_F(FolderStoreTest, OnDemandChangesNothing) {
  {
    FolderStore store = open();
    save(store);
  }
  const fs::path file = only_artefact();
  fs::resize_file(file, fs::file_size(file) - 1);
  EXPECT_FALSE(FolderStore(folder_, Access::on_demand).find("fpfh", key_of(recipe())));
  EXPECT_TRUE(fs::exists(file));
}

// On a network file system each stat takes its time, and a first run misses 70 000 times.
TEST_F(FolderStoreTest, AMissLooksAtNoFileOfAnotherKey) {
  FolderStore store = open();
  const Digest missing = key_of(recipe());
  Digest other = missing;
  other.low += 1;
  const fs::path file =
      folder_ / "fpfh" / missing.hex().substr(0, 2) / ArtefactName{"52", other, {}, 0, 1000}.text();
  fs::create_directories(file.parent_path());
  std::ofstream(file) << "truncated";
  EXPECT_FALSE(store.refresh_and_find("fpfh", missing));
  EXPECT_TRUE(fs::exists(file)) << "it was looked at, and found to be cut short";
}

TEST_F(FolderStoreTest, ArtefactsExplainThemselves) {
  FolderStore store = open();
  save(store);
  const auto bytes = read_bytes(only_artefact());
  const Attributes attributes = hdf5_content(*bytes, "artefact").attributes;
  EXPECT_EQ(std::get<std::string>(*find_attribute(attributes, "stage")), "fpfh");
  EXPECT_EQ(std::get<std::string>(*find_attribute(attributes, "options")), "k: 1\n");
  EXPECT_EQ(std::get<std::string>(*find_attribute(attributes, "inputs")),
            ("mesh: " + Digest{1, 2}.hex() + "\n"));
  EXPECT_EQ(std::get<std::int64_t>(*find_attribute(attributes, "stage_version")), 1);
  EXPECT_EQ(std::get<double>(*find_attribute(attributes, "seconds")), 0.5);
}

TEST_F(FolderStoreTest, TruncationAtEveryLengthIsAMiss) {
  {
    FolderStore store = open();
    save(store);
  }
  const fs::path path = only_artefact();
  const auto bytes = *read_bytes(path);
  for (std::size_t length = 0; length < bytes.size(); length += 3) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(length));
    EXPECT_FALSE(FolderStore(folder_, Access::read_only).find("fpfh", key_of(recipe()))) << length;
  }
}

TEST_F(FolderStoreTest, AFlippedByteAnywhereIsAMissAndTheFileIsMovedAside) {
  FolderStore first = open();
  save(first);
  const fs::path path = only_artefact();
  const auto bytes = *read_bytes(path);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    Bytes flipped = bytes;
    flipped[i] ^= std::byte{0x10};
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(flipped.data()), static_cast<std::streamsize>(flipped.size()));
    FolderStore store = open();
    EXPECT_TRUE(store.find("fpfh", key_of(recipe())));
    testing::internal::CaptureStdout();
    EXPECT_FALSE(store.load("fpfh", key_of(recipe()))) << i;
    EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr(path.filename().string()));
    EXPECT_FALSE(store.find("fpfh", key_of(recipe())));
    EXPECT_FALSE(fs::exists(path));
    EXPECT_TRUE(fs::exists(folder_ / "damaged" / path.filename()));
  }
}

TEST_F(FolderStoreTest, SavingAgainAfterDamageWorks) {
  FolderStore store = open();
  const Digest content = save(store);
  fs::resize_file(only_artefact(), 10);
  EXPECT_FALSE(store.load("fpfh", key_of(recipe())));
  EXPECT_EQ(save(store), content);
  EXPECT_TRUE(store.load("fpfh", key_of(recipe())));
}

TEST_F(FolderStoreTest, ReadOnlyAccessChangesNothing) {
  const fs::path missing = folder_ / "not-there";
  EXPECT_FALSE(FolderStore(missing, Access::read_only).find("fpfh", {}));
  EXPECT_FALSE(fs::exists(missing));
}

TEST_F(FolderStoreTest, OpeningItRemovesWhatDeadWritersLeftAndNothingThatIsBeingWritten) {
  open().prepare();
  const UnfinishedFile alive(folder_ / "tmp");
  const fs::path dead = folder_ / "tmp" / "0123456789abcdef.salbench-part";
  std::ofstream(dead) << "x";
  { FolderStore store = open(); }
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(alive.path()));
}

// Takes every file descriptor but a few that the process may have.
class FewOpenFiles {
 public:
  explicit FewOpenFiles(rlim_t left) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const int next = ::dup(STDIN_FILENO);  // the lowest that is free
    ::close(next);
    const rlimit few{static_cast<rlim_t>(next) + left, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  FewOpenFiles(const FewOpenFiles&) = delete;
  FewOpenFiles& operator=(const FewOpenFiles&) = delete;
  ~FewOpenFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(FolderStoreTest, AnErrorOfTheSystemIsNoDamage) {
  FolderStore store = open();
  const Digest content = save(store);
  std::exception_ptr thrown;  // looked at afterwards: a sanitizer opens files of its own
  {
    const FewOpenFiles none(0);
    try {
      store.load("fpfh", key_of(recipe()));
    } catch (...) {
      thrown = std::current_exception();
    }
  }
  ASSERT_TRUE(thrown);
  EXPECT_THAT([&] { std::rethrow_exception(thrown); },
              testing::ThrowsMessage<StorageError>(testing::AllOf(testing::HasSubstr("Too many open files"),
                                                                  testing::HasSubstr("--threads"))));
  EXPECT_FALSE(fs::exists(folder_ / "damaged"));
  EXPECT_EQ(store.find("fpfh", key_of(recipe())), content);
  EXPECT_TRUE(store.load("fpfh", key_of(recipe())));
}

TEST_F(FolderStoreTest, TheBytesOfAnArtefactAreCheckedBeforeTheyAreHandedOut) {
  FolderStore store = open();
  save(store);
  const fs::path file = only_artefact();
  EXPECT_EQ(store.image("fpfh", key_of(recipe())), read_bytes(file));
  fs::resize_file(file, fs::file_size(file) - 1);
  EXPECT_FALSE(store.image("fpfh", key_of(recipe())));
  EXPECT_TRUE(fs::exists(folder_ / "damaged" / file.filename()));
}

TEST_F(FolderStoreTest, UnusableFoldersAreToldApart) {
  const fs::path file = folder_ / "file";
  std::ofstream(file) << "x";
  EXPECT_THROW(FolderStore(file, Access::read_write), StorageError);
  for (const fs::path& folder : {file / "below", fs::path("/proc/salbench")}) {  // read-only, also for root
    FolderStore store(folder, Access::read_write);
    EXPECT_THROW(store.prepare(), StorageError);
    EXPECT_THROW(save(store), StorageError);
    EXPECT_THROW(store.prepare(), StorageError) << "asked again";
  }
}

TEST_F(FolderStoreTest, ANewerCacheFormatIsRefused) {
  open().prepare();
  std::ofstream(folder_ / "CACHEDIR.TAG") << "# salbench cache, format 999\n";
  EXPECT_THAT([&] { open(); }, testing::ThrowsMessage<StorageError>(testing::HasSubstr("newer")));
}

// A limit on the size of files stands in for a full disk: write() fails in the same place.
TEST_F(FolderStoreTest, AFullDiskIsAnErrorAndLeavesNoArtefact) {
  FolderStore store = open();
  rlimit unlimited{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const rlimit tiny{100, unlimited.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tiny), 0);
  EXPECT_THROW(save(store), StorageError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  EXPECT_FALSE(store.find("fpfh", key_of(recipe())));
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
  save(store);
  EXPECT_TRUE(store.load("fpfh", key_of(recipe())));
}

TEST_F(FolderStoreTest, TwoContentsUnderOneKeyAreSettledTheSameWayEverywhere) {
  FolderStore store = open();
  const Digest a = save(store, recipe(), 1), b = save(store, recipe(), 2);
  ASSERT_NE(a, b);
  EXPECT_EQ(store.find("fpfh", key_of(recipe())), std::min(a, b));
  EXPECT_EQ(open().find("fpfh", key_of(recipe())), std::min(a, b));
}

}  // namespace
}  // namespace salbench
