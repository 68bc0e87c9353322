// SPDX-License-Identifier: GPL-3.0-or-later
// Replays the corpora without libFuzzer, with any compiler.

#include "io/file.h"
#include "tests/fuzz/message.h"
#include "tests/fuzz/targets.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Replays each file and each of its beginnings, in increments of `step`, in memory of exactly that size,
// which AddressSanitizer guards.
void replay(const std::filesystem::path& folder, void (*target)(std::string_view), std::size_t step = 1) {
  int n_files = 0;
  for (const auto& file : std::filesystem::directory_iterator(SALBENCH_CORPUS / folder)) {
    const std::string bytes = read_file(file.path());
    for (std::size_t length = 0; length <= bytes.size();
         length += std::min(step, std::max<std::size_t>(1, bytes.size() - length))) {
      const std::vector<char> beginning(bytes.data(), bytes.data() + length);
      ASSERT_NO_THROW(target({beginning.data(), length}))
          << file.path() << ", the first " << length << " bytes";
    }
    ++n_files;
  }
  EXPECT_GT(n_files, 0);
}

TEST(FuzzCorpus, Off) { replay("off", fuzz_off); }
TEST(FuzzCorpus, Obj) { replay("obj", fuzz_obj); }
TEST(FuzzCorpus, Ply) { replay("ply", fuzz_ply); }
TEST(FuzzCorpus, PlyCloud) {
  replay("ply_cloud", fuzz_ply_cloud);
  replay("ply", fuzz_ply_cloud);
}
TEST(FuzzCorpus, Val) { replay("val", fuzz_val); }
TEST(FuzzCorpus, Pid) { replay("pid", fuzz_pid); }
TEST(FuzzCorpus, Head) { replay("head", fuzz_head, 7); }
TEST(FuzzCorpus, Config) { replay("config", fuzz_config, 5); }

TEST(FuzzMessage, IsOneLineThatNamesTheFile) {
  EXPECT_NO_THROW(check_message("a.off:3: \"x\" is not a number", "a.off"));
  EXPECT_THROW(check_message("a.off:3: two\nlines", "a.off"), std::logic_error);
  EXPECT_THROW(check_message("a.off:3: a bell\a", "a.off"), std::logic_error);
  EXPECT_THROW(check_message("b.off:3: another file", "a.off"), std::logic_error);
  EXPECT_THROW(check_message("", "a.off"), std::logic_error);
}

}  // namespace
}  // namespace salbench
