// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/nesting.h"

#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

bool is_here(const TemporaryFolder& cache) { return is_inside_function(cache.path(), ::gettid()); }

// In a copy of this process, and in a copy of that one.
bool is_in_a_copy(const TemporaryFolder& cache, int generations = 2) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(generations > 1 ? is_in_a_copy(cache, generations - 1) : is_here(cache));
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status) != 0;
}

TEST(Nesting, IsOfTheThreadInAFunctionAndOfProcessesThatItStarts) {
  const TemporaryFolder cache;
  EXPECT_FALSE(is_here(cache));
  EXPECT_FALSE(is_in_a_copy(cache));
  {
    const auto inside = enter_function(cache.path());
    EXPECT_TRUE(is_here(cache));
    EXPECT_TRUE(is_in_a_copy(cache));
  }
  EXPECT_FALSE(is_here(cache)) << "it has returned";
  EXPECT_FALSE(is_in_a_copy(cache));
}

TEST(Nesting, IsOfAThreadThatIsNotTheFirstOfItsProcess) {
  const TemporaryFolder cache;
  std::thread([&] {
    const auto inside = enter_function(cache.path());
    EXPECT_TRUE(is_here(cache));
    EXPECT_TRUE(is_in_a_copy(cache));
  }).join();
}

TEST(Nesting, IsNotOfOtherThreadsAndWhatTheyStartNorOfOtherCaches) {
  const TemporaryFolder cache, another;
  const auto inside = enter_function(cache.path());
  EXPECT_FALSE(is_here(another));
  EXPECT_FALSE(is_in_a_copy(another));
  std::thread([&] {
    EXPECT_FALSE(is_here(cache));
    EXPECT_FALSE(is_in_a_copy(cache));
  }).join();
}

}  // namespace
}  // namespace salbench
