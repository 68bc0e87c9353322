// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/depended_files.h"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

// A file that a command needs, as it was planned with "weights 1", and its modification time then.
struct Planned {
  Planned() { files.key_lines(); }

  TemporaryFolder folder;
  fs::path path = folder.write("weights", "weights 1");
  fs::file_time_type time = fs::last_write_time(path);
  DependedFiles files{{path.string()}, Section::from_text("", "test.yaml")};
};

void expect_change_is_noticed(Planned& planned) {
  EXPECT_THAT([&] { planned.files.check_unchanged(); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(planned.path.string()), HasSubstr("changed since"))));
}

TEST(DependedFiles, AreLookedUpBesideTheConfigurationFirst) {
  TemporaryFolder folder;
  folder.write("own.yaml", "key: 1");
  folder.write("weights", "beside");
  const Section written = Section::from_file((folder.path() / "own.yaml").string());
  EXPECT_EQ(place_of_depended("weights", written), folder.path() / "weights");
  EXPECT_EQ(place_of_depended("other", written), fs::current_path() / "other");
  EXPECT_EQ(place_of_depended("/etc/passwd", written), "/etc/passwd");
  EXPECT_EQ(place_of_depended("weights", Section::from_text("", "config")), fs::current_path() / "weights");
  DependedFiles files{{"weights"}, written};
  EXPECT_THAT(files.key_lines(), HasSubstr("depends on weights: "));
  files.link_into(folder.path() / "scratch");
  EXPECT_EQ(read_file(folder.path() / "scratch/weights"), "beside");
}

TEST(DependedFiles, ChangedInPlaceWithTheTimeKept) {
  Planned planned;
  planned.files.check_unchanged();
  planned.folder.write("weights", "weights 2");  // of the same size
  fs::last_write_time(planned.path, planned.time);
  expect_change_is_noticed(planned);
}

TEST(DependedFiles, ReplacedByAnotherFileOfTheSameTime) {
  Planned planned;
  const fs::path other = planned.folder.write("other", "weights 2");
  fs::last_write_time(other, planned.time);
  fs::rename(other, planned.path);
  expect_change_is_noticed(planned);
}

TEST(DependedFiles, LinkedToAnotherFileOfTheSameTime) {
  Planned planned;
  const fs::path other = planned.folder.write("other", "weights 2");
  fs::last_write_time(other, planned.time);
  fs::remove(planned.path);
  fs::create_symlink(other, planned.path);
  expect_change_is_noticed(planned);
}

TEST(DependedFiles, WrittenAgainWithTheSameContent) {
  Planned planned;
  planned.folder.write("weights", "weights 1");
  fs::last_write_time(planned.path, planned.time + std::chrono::hours(1));
  EXPECT_NO_THROW(planned.files.check_unchanged());
}

TEST(DependedFiles, Removed) {
  Planned planned;
  fs::remove(planned.path);
  EXPECT_THAT([&] { planned.files.check_unchanged(); },
              ThrowsMessage<InputError>(HasSubstr(planned.path.string())));
}

}  // namespace
}  // namespace salbench
