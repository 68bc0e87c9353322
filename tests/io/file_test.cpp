// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/file.h"

#include <csignal>
#include <cstdio>
#include <iterator>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(File, ReturnsTheBytesThatWereWritten) {
  const TemporaryFolder folder;
  const std::string bytes("a\r\nb\0\xff\n", 7);
  write_file(folder / "x.csv", bytes);
  EXPECT_EQ(read_file(folder / "x.csv"), bytes);
  write_file(folder / "x.csv", "");
  EXPECT_EQ(read_file(folder / "x.csv"), "");
}

// Sparse files take neither disk nor, since their size is checked first, memory.
TEST(File, TheSizeIsJudgedBeforeItIsRead) {
  const TemporaryFolder folder;
  const auto path = folder.write("1.off", "OFF\n");
  std::filesystem::resize_file(path, kMaxItemBytes + 1);
  EXPECT_THAT([&] { read_file(path, kMaxItemBytes); },
              Refuses("1.off: 2147483649 bytes: at most 2147483648 can be read; "));
  std::filesystem::resize_file(path, 4);
  EXPECT_EQ(read_file(path, 4), "OFF\n");
  EXPECT_THROW(read_file(path, 3), InputError);
}

// Exits with status 0 and the message, when the file exceeds a limit of 64 MiB above the process's memory.
[[noreturn]] void read_with_little_memory(const std::filesystem::path& path) {
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (64U << 20U);
  const rlimit little = {bytes, bytes};
  setrlimit(RLIMIT_AS, &little);
  try {
    read_file(path);
  } catch (const InputError& error) {
    std::fputs(error.what(), stderr);
    _exit(0);
  }
  _exit(1);
}

TEST(File, ThatMemoryDoesNotHoldIsNamed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit leaves";
#endif
  const TemporaryFolder folder;
  const auto path = folder.write("1.off", "OFF\n");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 30U);
  EXPECT_EXIT(read_with_little_memory(path), testing::ExitedWithCode(0),
              "1.off: no memory for its 1073741824 bytes; use fewer --threads");
}

// The kernel hands out its own files a page at a time.
TEST(File, IsReadToItsEndInSeveralGoes) {
  const std::filesystem::path path = "/sys/kernel/btf/vmlinux";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "this kernel has no such file";
  std::ifstream file(path, std::ios::binary);
  EXPECT_EQ(read_file(path), std::string(std::istreambuf_iterator<char>(file), {}));
}

TEST(File, LeavesNoTemporaryFileBehind) {
  const TemporaryFolder folder;
  write_file(folder / "x.csv", "old");
  write_file(folder / "x.csv", "new");
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THROW(write_file(folder / "taken", "text"), StorageError);
  using Entries = std::filesystem::directory_iterator;
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 2);
}

TEST(File, OfAWriterThatWasKilledNothingStays) {
  const TemporaryFolder folder;
  write_file(folder / "x.csv", "text");
  const pid_t writer = ::fork();
  if (writer == 0) {  // for a text beyond a limit whose signal kills
    const rlimit limit{4096, 4096}, no_core{0, 0};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::signal(SIGXFSZ, SIG_DFL);
    write_file(folder / "x.csv", std::string(100'000, 'x'));
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(writer, &status, 0), writer);
  ASSERT_TRUE(WIFSIGNALED(status));
  using Entries = std::filesystem::directory_iterator;
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 2);
  visit_abandoned(folder.path(), [](const std::filesystem::path& file) { std::filesystem::remove(file); });
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 1);
  EXPECT_EQ(read_file(folder / "x.csv"), "text");
}

TEST(File, SaysWhyAFileCannotBeWrittenOrRead) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { write_file(folder / "no_such_folder" / "x.csv", "text"); },
              Refuses<StorageError>("no_such_folder: ", "No such file"));
  EXPECT_THAT([&] { read_file(folder / "absent.off"); }, Refuses("absent.off: ", "No such file"));
  EXPECT_THAT([&] { read_file(folder.path()); }, Refuses("is a folder"));
  EXPECT_THAT([] { read_file("/dev/null"); }, Refuses("not a regular file"));
  ASSERT_EQ(::mkfifo((folder / "pipe.off").c_str(), 0600), 0);  // never waited for
  EXPECT_THAT([&] { read_file(folder / "pipe.off"); }, Refuses("pipe.off: is not a regular file"));
}

// Two containers may share host name and process numbers: file names must not depend on either.
TEST(File, TwoWritersOfOneNumberNeverShareATemporaryFile) {
  const TemporaryFolder folder;
  const UnfinishedFile first(folder.path());
  const pid_t child = ::fork();
  if (child == 0) {
    const UnfinishedFile second(folder.path());
    ::_exit(second.path() != first.path() && std::filesystem::exists(first.path()) ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(File, WhatALivingWriterHoldsIsNotAbandoned) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> abandoned;
  const auto look = [&] {
    abandoned.clear();
    visit_abandoned(folder.path(), [&](const std::filesystem::path& file) { abandoned.push_back(file); });
  };
  {
    UnfinishedFile file(folder.path());
    look();
    EXPECT_TRUE(abandoned.empty());
    file.finish(folder / "done");
    look();
    EXPECT_TRUE(abandoned.empty());
  }
  const std::filesystem::path left = folder.write("0000000000000000.salbench-part", "x");
  look();
  EXPECT_EQ(abandoned, std::vector{left});
}

TEST(File, ListsAFolderByNameAndTellsFoldersApart) {
  const TemporaryFolder folder;
  folder.write("b", "");
  folder.write("c/d", "");
  std::filesystem::create_symlink("nowhere", folder / "a");
  std::vector<std::pair<std::string, bool>> entries;
  for (const FolderEntry& entry : list_folder(folder.path()))
    entries.emplace_back(entry.path.filename(), entry.is_folder);
  EXPECT_EQ(entries, (std::vector<std::pair<std::string, bool>>{{"a", false}, {"b", false}, {"c", true}}));
  EXPECT_TRUE(list_folder(folder / "absent").empty());
  EXPECT_TRUE(list_folder(folder / "b").empty()) << "a file is no folder";
}

}  // namespace
}  // namespace salbench
