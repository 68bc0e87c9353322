// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/claim.h"

#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Claim, IsOneProcessesAndEndsWithTheObject) {
  const TemporaryFolder cache, elsewhere;
  auto mine = claim_in(cache.path(), "family 1");
  EXPECT_NE(mine, nullptr);
  EXPECT_EQ(claim_in(cache.path(), "family 1"), nullptr);
  const auto other = claim_in(cache.path(), "family 2");
  EXPECT_NE(other, nullptr);
  EXPECT_EQ(claim_in(cache.path(), "family 1"), nullptr) << "dropped when another descriptor was closed";
  EXPECT_NE(claim_in(elsewhere.path(), "family 1"), nullptr) << "of another cache";
  mine.reset();
  EXPECT_NE(claim_in(cache.path(), "family 1"), nullptr);
}

TEST(Claim, IsSeenWithoutBeingTaken) {
  const TemporaryFolder cache;
  EXPECT_FALSE(is_claimed_in(cache.path(), "family 1")) << "there is no file of claims yet";
  auto mine = claim_in(cache.path(), "family 1");
  EXPECT_TRUE(is_claimed_in(cache.path(), "family 1"));
  EXPECT_FALSE(is_claimed_in(cache.path(), "family 2"));
  mine.reset();
  EXPECT_FALSE(is_claimed_in(cache.path(), "family 1"));
  EXPECT_NE(claim_in(cache.path(), "family 1"), nullptr) << "looking at it took it";
}

TEST(Claim, DiesWithItsProcess) {
  const TemporaryFolder cache;
  int held[2];
  ASSERT_EQ(::pipe(held), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto claim = claim_in(cache.path(), "family 1");
    const char byte = claim ? 'y' : 'n';
    if (::write(held[1], &byte, 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(held[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'y');
  EXPECT_EQ(claim_in(cache.path(), "family 1"), nullptr);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NE(claim_in(cache.path(), "family 1"), nullptr);
  for (const int end : held) ::close(end);
}

TEST(Claim, EndsWithTheObjectThoughAForkedProcessHasACopyOfItsFile) {
  const TemporaryFolder cache;
  auto claim = claim_in(cache.path(), "family 1");
  const pid_t child = ::fork();
  if (child == 0)
    for (;;) ::pause();
  claim.reset();
  EXPECT_FALSE(is_claimed_in(cache.path(), "family 1"));
  EXPECT_NE(claim_in(cache.path(), "family 1"), nullptr);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(Claim, WhereThereCanBeNoLocksEverythingIsGranted) {
  EXPECT_NE(claim_in("/no/such/folder", "family 1"), nullptr);
  EXPECT_NE(claim_in("/no/such/folder", "family 1"), nullptr);
}

}  // namespace
}  // namespace salbench
