// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/depended_files.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

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
  files.put_into(folder.path() / "scratch");
  EXPECT_EQ(read_file(folder.path() / "scratch/weights"), "beside");
}

// Files a.py and sub/b.py beside a configuration.
struct Named {
  explicit Named(const Words& names)
      : files{names, Section::from_file(folder.write("own.yaml", "key: 1").string())} {
    folder.write("a.py", "a");
    folder.write("sub/b.py", "b");
  }
  std::vector<fs::path> placed(const char* below) {
    files.put_into(folder / below);
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder / below))
      if (!entry.is_directory()) found.push_back(entry.path().lexically_relative(folder / below));
    std::ranges::sort(found);
    return found;
  }

  TemporaryFolder folder;
  DependedFiles files;
};

TEST(DependedFiles, HoweverOftenAndInWhateverWaysOneIsNamedItIsOne) {
  const std::string once = Named({"a.py", "sub/b.py"}).files.key_lines();
  for (const Words& names : {Words{"a.py", "sub/b.py", "./a.py"}, Words{"a.py", "a.py", "sub/b.py"},
                             Words{"a.py", "sub/b.py", "sub//b.py", "./sub/./b.py"}}) {
    Named named(names);
    EXPECT_EQ(named.files.key_lines(), once);
    EXPECT_THAT(named.placed("scratch"), ElementsAre("a.py", "sub/b.py"));
  }
  EXPECT_THAT(Named({"./a.py"}).files.key_lines(), HasSubstr("depends on ./a.py: ")) << "as it always was";
}

TEST(DependedFiles, AreCopiedOnceForAllShapesWithWhatTheSystemLetsDoWithThem) {
  Named named({"a.py", "linked.py"});
  fs::create_symlink("a.py", named.folder / "linked.py");
  fs::permissions(named.folder / "a.py", fs::perms::owner_exec, fs::perm_options::add);
  for (const char* below : {"first", "second"}) {
    EXPECT_THAT(named.placed(below), ElementsAre("a.py", "linked.py"));
    EXPECT_EQ(fs::canonical(named.folder / below / "linked.py").parent_path().filename(), below);
  }
  EXPECT_TRUE(fs::equivalent(named.folder / "first/a.py", named.folder / "second/a.py"));
  EXPECT_FALSE(fs::equivalent(named.folder / "first/a.py", named.folder / "a.py"));
  EXPECT_NE(fs::status(named.folder / "second/a.py").permissions() & fs::perms::owner_exec, fs::perms::none);
}

TEST(DependedFiles, WhatACommandWritesIntoACopyIsNoticedAndTheOriginalIsAsItWas) {
  Named named({"a.py"});
  named.placed("first");
  EXPECT_NO_THROW(named.files.check_unchanged());
  named.folder.write("first/a.py", "b");
  const auto written = ThrowsMessage<InputError>(HasSubstr("a.py: the command has written into its copy"));
  EXPECT_THAT([&] { named.files.check_unchanged(); }, written);
  EXPECT_THAT([&] { named.placed("second"); }, written);
  EXPECT_EQ(read_file(named.folder / "a.py"), "a");
}

TEST(DependedFiles, EditedAfterTheyWereCopiedCountAsTheyWerePlanned) {
  Named named({"a.py"});
  named.placed("first");
  named.folder.write("a.py", "edited");
  EXPECT_NO_THROW(named.files.check_unchanged());
  named.placed("second");
  EXPECT_EQ(read_file(named.folder / "second/a.py"), "a");
}

TEST(DependedFiles, EditedBetweenThePlanAndTheCopy) {
  Named named({"a.py"});
  named.files.key_lines();
  named.folder.write("a.py", "edited");
  EXPECT_THAT([&] { named.placed("first"); }, ThrowsMessage<InputError>(HasSubstr("a.py: changed since")));
}

TEST(DependedFiles, OneThatIsLeftOutIsNamedWhereAFailureSpeaksOfIt) {
  Named named({"a.py", "sub/b.py"});
  for (const char* name : {"helper.py", "weights", "sub/c.txt", "package/__init__.py"})
    named.folder.write(name, "");
  const auto left_out = [&](const char* text) { return named.files.left_out_of(text); };
  EXPECT_EQ(left_out("ModuleNotFoundError: No module named 'helper'"),
            "; helper.py is not in the command's folder: add it to depends");
  EXPECT_EQ(left_out("No such file or directory: '/tmp/salbench-scratch-1/sub/c.txt'"),
            "; sub/c.txt is not in the command's folder: add it to depends");
  EXPECT_EQ(left_out("cat: weights: No such file"),
            "; weights is not in the command's folder: add it to depends");
  EXPECT_EQ(left_out("No module named 'package.parts'"),
            "; package is not in the command's folder: add its files to depends");
  for (const char* of_others :
       {"No module named 'helpers'", "File \"a.py\", line 3", "my weights are wrong", ""})
    EXPECT_EQ(left_out(of_others), "") << of_others;
}

struct Planned {
  fs::path file, other;  // with "weights 1" and "weights 2"
};

// Whatever size and time say, another content is noticed, and the same is not.
TEST(DependedFiles, AreComparedByTheirContent) {
  struct Case {
    const char* name;
    void (*change)(const Planned& planned);
    const char* said;
  };
  const Case cases[] = {
      {"untouched", [](const Planned&) {}, ""},
      {"written again", [](const Planned& planned) { std::ofstream(planned.file) << "weights 1"; }, ""},
      {"edited in place", [](const Planned& planned) { std::ofstream(planned.file) << "weights 2"; },
       "changed since"},
      {"replaced", [](const Planned& planned) { fs::rename(planned.other, planned.file); }, "changed since"},
      {"linked",
       [](const Planned& planned) {
         fs::remove(planned.file);
         fs::create_symlink(planned.other, planned.file);
       },
       "changed since"},
      {"removed", [](const Planned& planned) { fs::remove(planned.file); }, "weights"}};
  for (const auto& [name, change, said] : cases) {
    const TemporaryFolder folder;
    const Planned planned{folder.write("weights", "weights 1"), folder.write("other", "weights 2")};
    const fs::file_time_type time = fs::last_write_time(planned.file);
    DependedFiles files{{planned.file.string()}, Section::from_text("", "test.yaml")};
    files.key_lines();
    change(planned);
    const std::chrono::hours later(std::string_view(name) == "written again" ? 1 : 0);
    if (fs::exists(planned.file)) fs::last_write_time(planned.file, time + later);
    if (*said == '\0')
      EXPECT_NO_THROW(files.check_unchanged()) << name;
    else
      EXPECT_THAT([&] { files.check_unchanged(); },
                  ThrowsMessage<InputError>(AllOf(HasSubstr(planned.file.string()), HasSubstr(said))))
          << name;
  }
}

}  // namespace
}  // namespace salbench
