// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/child_process.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/processes.h"

namespace salbench {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

constexpr ChildLimits kLimits = {.processor_time = std::chrono::seconds(60)};

std::string failure_of(const std::function<void()>& function, const ChildLimits& limits = kLimits) {
  return run_in_child(limits, [&](const Send&) { function(); }).failure;
}

TEST(ChildProcess, SendsMoreThanAPipeHolds) {
  const std::string text(3'000'001, 'x');
  const ChildResult result = run_in_child(kLimits, [&](const Send& send) {
    send(std::as_bytes(std::span("<", 1)));
    send(std::as_bytes(std::span(text)));
  });
  EXPECT_EQ(result.sent, "<" + text);
  EXPECT_EQ(result.failure, "");
}

TEST(ChildProcess, ItsMemoryIsItsOwn) {
  int value = 1;
  EXPECT_EQ(failure_of([&] { value = 2; }), "");
  EXPECT_EQ(value, 1);
}

TEST(ChildProcess, SaysHowItEnded) {
  // A sanitizer turns the signal into a status.
  EXPECT_THAT(failure_of([] { std::raise(SIGSEGV); }),
              AnyOf("crashed (signal 11: Segmentation fault)", HasSubstr("ended with status")));
  EXPECT_EQ(failure_of([] { std::raise(SIGKILL); }), "crashed (signal 9: Killed)");
  EXPECT_EQ(failure_of([] { std::_Exit(7); }), "ended with status 7");
  EXPECT_EQ(failure_of([] { throw std::runtime_error("no"); }), "ended with status 1");
  EXPECT_EQ(failure_of([] { throw std::bad_alloc(); }), "ran out of memory");
}

TEST(ChildProcess, WhatWasSentBeforeACrashIsNoWholeResult) {
  const ChildResult result = run_in_child(kLimits, [](const Send& send) {
    send(std::as_bytes(std::span("half", 4)));
    std::raise(SIGKILL);
  });
  EXPECT_EQ(result.sent, "half");
  EXPECT_EQ(result.failure, "crashed (signal 9: Killed)");
}

TEST(ChildProcess, HasSoMuchProcessorTime) {
  const auto forever = [] {
    for (std::atomic<int> i = 0;; ++i) {
    }
  };
  EXPECT_EQ(failure_of(forever, {.processor_time = std::chrono::seconds(1)}),
            "took more than 1 s of processor time");
}

TEST(ChildProcess, HasSoMuchMemory) {
  const ChildLimits limits = {.processor_time = std::chrono::seconds(60), .memory = 64U << 20U};
  const auto take = [](std::size_t bytes) {
    std::vector<char> taken(bytes, 'x');
    if (taken[bytes / 2] != 'x') throw std::runtime_error("lost");
  };
  EXPECT_EQ(failure_of([&] { take(16U << 20U); }, limits), "");
  // A sanitizer ends the process where there is no memory.
  EXPECT_THAT(failure_of([&] { take(256U << 20U); }, limits),
              AnyOf("took more than 64 MiB of memory", HasSubstr("ended with status")));
}

// A terminal sends an interrupt to both: the program decides what comes of it.
TEST(ChildProcess, LeavesInterruptsToTheProgram) {
  EXPECT_EQ(failure_of([] {
              for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::raise(signal);
            }),
            "");
}

TEST(ChildProcess, ManyThreadsGetEachTheirOwn) {
  std::vector<std::thread> threads;
  std::atomic<int> sound = 0;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&sound, t] {
      const std::string text(200'000, static_cast<char>('a' + t));
      const auto result =
          run_in_child(kLimits, [&](const Send& send) { send(std::as_bytes(std::span(text))); });
      sound += result.sent == text && result.failure.empty() ? 1 : 0;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(sound, 8);
}

TEST(ChildProcess, LeavesNoProcessBehind) {
  const auto before = own_children();
  failure_of([] {});
  failure_of([] { std::raise(SIGKILL); });
  EXPECT_EQ(own_children(), before);
}

}  // namespace
}  // namespace salbench
