// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/folder_store.h"

#include <atomic>
#include <thread>

#include <sys/resource.h>
#include <unistd.h>

#include "cache/layout.h"
#include "io/file.h"
#include "tests/support/cache_files.h"
#include "tests/support/h5py.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class FolderStoreTest : public testing::Test {
 protected:
  FolderStore open() const { return {folder_, Access::read_write}; }

  static Recipe recipe(const std::string& options = "k: 1\n") {
    return {"fpfh", 1, options, "", {{"mesh", {1, 2}}}};
  }
  static Arrays arrays(double value = 1) {
    return {{"saliency", {3}, std::vector<double>{value, 2, 3}, "1", "three values"}};
  }
  // Saves and flushes.
  Digest save(FolderStore& store, const Recipe& what = recipe(), double value = 1) const {
    keep(store, what, value);
    store.flush("52");
    return content_digest(arrays(value));
  }
  static void keep(FolderStore& store, const Recipe& what, double value = 1, double seconds = 0.5) {
    store.save("52", artefact_of(what, "field", arrays(value), {"52", seconds, "odd"}));
  }
  std::vector<fs::path> files() const { return list_segments(folder_); }
  fs::path only_file() const {
    EXPECT_EQ(files().size(), 1U);
    return files().front();
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(FolderStoreTest, FindsWhatItSavedAlsoWhenOpenedAgain) {
  FolderStore store = open();
  EXPECT_FALSE(store.find(key_of(recipe())));
  const Digest content = save(store);
  EXPECT_EQ(store.find(key_of(recipe())), content);
  FolderStore again(folder_, Access::read_only);
  EXPECT_EQ(again.find(key_of(recipe())), content);
  EXPECT_TRUE(again.has_item("fpfh", "52"));
  EXPECT_FALSE(again.has_item("fpfh", "53"));
  ASSERT_TRUE(again.load(key_of(recipe())));
  EXPECT_EQ(again.load(key_of(recipe()))->at(0).values, arrays()[0].values);
}

TEST_F(FolderStoreTest, TellsWhatWasNotedOfEachFileThatHasAnArtefact) {
  FolderStore store = open(), theirs = open();
  keep(store, recipe(), 1, 0.5);
  std::vector<double> seconds;
  const auto noted = [&](const FolderStore& of, const std::vector<Digest>& keys) {
    seconds.clear();
    of.visit_notes(keys, [&](const Digest& key, const ArtefactNote& note) {
      EXPECT_EQ(key, key_of(recipe()));
      EXPECT_EQ(note.item, "52");
      seconds.push_back(note.seconds);
    });
    return seconds;
  };
  const std::vector<Digest> keys = {key_of(recipe()), key_of(recipe("k: 2\n"))};
  EXPECT_THAT(noted(store, keys), ElementsAre(0.5)) << "before it is written";
  store.flush("52");
  EXPECT_THAT(noted(store, keys), ElementsAre(0.5));
  keep(theirs, recipe(), 1, 0.25);  // by a process that has not seen it
  theirs.flush("52");
  const FolderStore both(folder_, Access::read_only);
  EXPECT_THAT(noted(both, keys), UnorderedElementsAre(0.5, 0.25));
  for (const fs::path& file : files()) fs::resize_file(file, 100);
  EXPECT_THAT(noted(both, keys), IsEmpty());
}

TEST_F(FolderStoreTest, SeesWhatAnotherProcessStored) {
  FolderStore mine = open(), theirs = open();
  const Digest content = save(theirs);
  EXPECT_FALSE(mine.find(key_of(recipe())));
  mine.refresh("53");
  EXPECT_FALSE(mine.find(key_of(recipe()))) << "it looks at one family";
  mine.refresh("52");
  EXPECT_EQ(mine.find(key_of(recipe())), content);
  EXPECT_EQ(mine.remark(key_of(recipe())), "odd");
}

TEST_F(FolderStoreTest, OfAShareOpensItsOwnFamiliesAndWhatIsMadeOfAll) {
  FolderStore all = open();
  save(all);
  all.save("", artefact_of(recipe("k: of all\n"), "fpfh", arrays(), {.item = "meshes"}));
  all.flush_all();
  const auto finds = [&](std::vector<std::string> families, const char* options) {
    const FolderStore store(folder_, Access::read_only, std::move(families));
    return store.find(key_of(recipe(options))).has_value();
  };
  EXPECT_TRUE(finds({"51", "52"}, recipe().options.c_str()));
  EXPECT_FALSE(finds({"51", "53"}, recipe().options.c_str()));
  EXPECT_TRUE(finds({"51"}, "k: of all\n"));
}

// Saved artefacts are found and loaded at once, and written to a file with their family.
TEST_F(FolderStoreTest, WhatIsSavedIsWrittenWithItsFamily) {
  FolderStore store = open();
  keep(store, recipe("k: 1\n"));
  keep(store, recipe("k: 2\n"));
  EXPECT_TRUE(store.find(key_of(recipe("k: 2\n"))));
  EXPECT_TRUE(store.load(key_of(recipe("k: 2\n"))));
  EXPECT_EQ(store.remark(key_of(recipe("k: 2\n"))), "odd");
  EXPECT_THAT(files(), IsEmpty());
  store.flush("53");
  EXPECT_THAT(files(), IsEmpty());
  store.flush("52");
  EXPECT_THAT(files(), SizeIs(1));
  EXPECT_EQ(open().usage().at(0).artefacts, 2U);
  store.flush("52");
  EXPECT_THAT(files(), SizeIs(1)) << "nothing is left to be written";
}

TEST_F(FolderStoreTest, MuchThatIsUnsavedIsWrittenEarlier) {
  FolderStore store = open();
  keep(store, recipe("k: 1\n"), 1, 2.5);
  EXPECT_THAT(files(), IsEmpty());
  keep(store, recipe("k: 2\n"), 1, 2.5);
  EXPECT_THAT(files(), SizeIs(1)) << "5 s of work";
  store.save("53", artefact_of(recipe("k: 3\n"), "field",
                               {{"saliency", {9'000'000}, std::vector<double>(9'000'000), "1", ""}}, {"53"}));
  EXPECT_THAT(files(), SizeIs(2)) << "72 MB";
}

TEST_F(FolderStoreTest, AnyReaderOfHdf5ShowsTheArrays) {
  FolderStore store = open();
  const Arrays of_each_type = {{"packed", {40'000, 2}, std::vector<float>(80'000, 0.5F), "1", "in chunks"},
                               {"plain", {3}, std::vector<double>{1, 2, 3}, "m", ""},
                               {"group/scalar", {}, std::vector<std::int64_t>{1LL << 40}, "1", ""},
                               {"whole", {2}, std::vector<std::int32_t>{-1, 8}, "1", ""},
                               {"bytes", {2}, std::vector<std::uint8_t>{1, 255}, "1", ""},
                               {"none", {0, 3}, std::vector<double>{}, "m", "no rows"}};
  store.save("52", artefact_of(recipe(), "field", of_each_type, {"52"}));
  store.flush("52");
  const auto place = store.location(key_of(recipe()));
  ASSERT_TRUE(place);
  EXPECT_EQ(place->file, only_file());
  EXPECT_EQ(place->group, "fpfh/52");
  EXPECT_EQ(shown_by_h5py(only_file(), "fpfh/52"), R"(bytes uint8 (2,) 256 1
group/scalar int64 () 1.09951e+12 1
none float64 (0, 3) 0 m
packed float32 (40000, 2) 40000 1
plain float64 (3,) 6 m
whole int32 (2,) 7 1
)");
}

// SegmentTest flips and truncates at every position of a file; this is the store's reaction.
TEST_F(FolderStoreTest, ASegmentInWhichDamageIsFoundIsNamedAndRenamed) {
  for (const bool is_open : {false, true}) {
    FolderStore first = open();
    keep(first, recipe("k: 2\n"), 7);
    const Digest content = save(first);
    const fs::path path = only_file(), aside = path.string() + ".damaged";
    damage(folder_, "fpfh", "52");
    testing::internal::CaptureStdout();
    std::optional<FolderStore> later;
    FolderStore& store = is_open ? first : later.emplace(folder_, Access::read_write);
    EXPECT_EQ(store.find(key_of(recipe())).has_value(), is_open) << "read to its end when a store is opened";
    EXPECT_FALSE(store.load(key_of(recipe())));
    EXPECT_THAT(
        testing::internal::GetCapturedStdout(),
        AllOf(HasSubstr(path.string()), HasSubstr("checksum mismatch"), HasSubstr("renamed to *.damaged")));
    EXPECT_FALSE(fs::exists(path));
    EXPECT_TRUE(fs::exists(aside));
    EXPECT_FALSE(store.find(key_of(recipe("k: 2\n")))) << "what else was in it has gone with it";
    EXPECT_EQ(save(store), content) << "it is stored again";
    EXPECT_TRUE(open().load(key_of(recipe())));
    EXPECT_TRUE(fs::exists(aside)) << "until gc removes it";
    fs::remove_all(folder_);
  }
}

TEST_F(FolderStoreTest, ThreadsThatFindDamageInOneSegmentAllSeeAMiss) {
  FolderStore store = open();
  std::vector<Recipe> recipes;
  for (int k = 0; k < 8; ++k) keep(store, recipes.emplace_back(recipe("k: " + std::to_string(k) + "\n")));
  store.flush("52");
  damage(folder_, "fpfh", "52");
  std::atomic<int> misses = 0;
  std::vector<std::thread> threads;
  for (const Recipe& each : recipes)
    threads.emplace_back([&] { misses += store.load(key_of(each)) ? 0 : 1; });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(misses, 8);
  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(list_damaged(folder_), SizeIs(1));
}

// Damage that leaves the time stamp, such as a disk's, is found on reading. A read-only user renames nothing.
TEST_F(FolderStoreTest, SegmentsAreReadToTheirEndOnlyIfTheyChangedSinceTheLastCheck) {
  FolderStore writer = open();
  save(writer);
  damage_unseen(folder_, "fpfh", "52");
  EXPECT_TRUE(open().find(key_of(recipe()))) << "it was sound at that time";
  forget_check(folder_);
  EXPECT_TRUE(FolderStore(folder_, Access::read_only).find(key_of(recipe())));
  EXPECT_THAT(files(), SizeIs(1));
  EXPECT_FALSE(open().find(key_of(recipe())));
  EXPECT_THAT(files(), IsEmpty());
  EXPECT_GT(last_check(folder_), 0) << "what is left is sound";
}

TEST_F(FolderStoreTest, FilesThatWereExchangedAreNotBelieved) {
  FolderStore store = open();
  save(store, recipe("k: 1\n"));
  save(store, recipe("k: 2\n"));
  ASSERT_THAT(files(), SizeIs(2));
  const fs::path a = files()[0], b = files()[1];
  fs::rename(a, folder_ / "c");
  fs::rename(b, a);
  fs::rename(folder_ / "c", b);
  FolderStore again = open();
  EXPECT_FALSE(again.find(key_of(recipe("k: 1\n"))));
  EXPECT_FALSE(store.load(key_of(recipe("k: 1\n")))) << "who had read the heads before";
}

TEST_F(FolderStoreTest, ReadOnlyAccessChangesNothing) {
  const fs::path missing = folder_ / "not-there";
  EXPECT_FALSE(FolderStore(missing, Access::read_only).find({}));
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

TEST_F(FolderStoreTest, AnErrorOfTheSystemIsNoDamage) {
  FolderStore store = open();
  const Digest content = save(store);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int lowest = ::dup(STDIN_FILENO);
  ::close(lowest);
  const rlimit none_left{static_cast<rlim_t>(lowest), before.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &none_left);
  std::exception_ptr thrown;  // examined afterwards: a sanitizer opens files of its own
  try {
    store.load(key_of(recipe()));
  } catch (...) {
    thrown = std::current_exception();
  }
  ::setrlimit(RLIMIT_NOFILE, &before);
  ASSERT_TRUE(thrown);
  EXPECT_THAT([&] { std::rethrow_exception(thrown); },
              ThrowsMessage<StorageError>(AllOf(HasSubstr("Too many open files"), HasSubstr("--threads"))));
  EXPECT_THAT(list_damaged(folder_), IsEmpty());
  EXPECT_EQ(store.find(key_of(recipe())), content);
  EXPECT_TRUE(store.load(key_of(recipe())));
}

TEST_F(FolderStoreTest, UnusableFoldersAreToldApart) {
  const fs::path file = folder_ / "file";
  std::ofstream(file) << "x";
  EXPECT_THROW(FolderStore(file, Access::read_write), StorageError);
  for (const fs::path& folder : {file / "below", fs::path("/proc/salbench")}) {  // read-only even for root
    FolderStore store(folder, Access::read_write);
    EXPECT_THROW(store.prepare(), StorageError);
    EXPECT_THROW(keep(store, recipe()), StorageError);
    EXPECT_THROW(store.prepare(), StorageError) << "asked again";
  }
}

TEST_F(FolderStoreTest, ANewerCacheFormatIsRefused) {
  open().prepare();
  std::ofstream(folder_ / "CACHEDIR.TAG") << "# salbench cache, format 999\n";
  EXPECT_THAT([&] { open(); }, Refuses<StorageError>("newer"));
}

TEST_F(FolderStoreTest, TwoContentsUnderOneKeyAreSettledTheSameWayEverywhere) {
  FolderStore store = open();
  const Digest a = save(store, recipe(), 1), b = save(store, recipe(), 2);
  ASSERT_NE(a, b);
  EXPECT_EQ(store.find(key_of(recipe())), std::min(a, b));
  EXPECT_EQ(open().find(key_of(recipe())), std::min(a, b));
}

}  // namespace
}  // namespace salbench
