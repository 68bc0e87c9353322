#include "io/text_file.h"

#include <csignal>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(TextFile, ReturnsTheBytesThatWereWritten) {
  const TemporaryFolder folder;
  const std::string bytes("a\r\nb\0\xff\n", 7);
  write_text_file(folder / "x.csv", bytes);
  EXPECT_EQ(read_file(folder / "x.csv"), bytes);
  write_text_file(folder / "x.csv", "");
  EXPECT_EQ(read_file(folder / "x.csv"), "");
}

TEST(TextFile, LeavesNoTemporaryFileBehind) {
  const TemporaryFolder folder;
  write_text_file(folder / "x.csv", "old");
  write_text_file(folder / "x.csv", "new");
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THROW(write_text_file(folder / "taken", "text"), StorageError);
  using Entries = std::filesystem::directory_iterator;
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 2);
}

TEST(TextFile, OfAWriterThatWasKilledNothingStays) {
  const TemporaryFolder folder;
  write_text_file(folder / "x.csv", "text");
  const pid_t writer = ::fork();
  if (writer == 0) {  // of a text that is too long for a limit that kills
    const rlimit limit{4096, 4096}, no_core{0, 0};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::signal(SIGXFSZ, SIG_DFL);
    write_text_file(folder / "x.csv", std::string(100'000, 'x'));
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(writer, &status, 0), writer);
  ASSERT_TRUE(WIFSIGNALED(status));
  using Entries = std::filesystem::directory_iterator;
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 2);
  remove_unfinished(folder.path());
  EXPECT_EQ(std::distance(Entries(folder.path()), Entries()), 1);
  EXPECT_EQ(read_file(folder / "x.csv"), "text");
}

TEST(TextFile, SaysWhyAFileCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      [&] { write_text_file(folder / "no_such_folder" / "x.csv", "text"); },
      ThrowsMessage<StorageError>(HasSubstr("no_such_folder/x.csv: cannot be written: No such file")));
}

TEST(TextFile, SaysWhyAFileCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_file(folder / "absent.off"); },
              ThrowsMessage<InputError>(HasSubstr("absent.off: cannot be read: No such file")));
  EXPECT_THAT([&] { read_file(folder.path()); }, ThrowsMessage<InputError>(HasSubstr("is a folder")));
  EXPECT_THAT([] { read_file("/dev/null"); }, ThrowsMessage<InputError>(HasSubstr("not a regular file")));
}

}  // namespace
}  // namespace salbench
