// SPDX-License-Identifier: GPL-3.0-or-later
// A command as a process group, for what runs it (process.cpp, serving_command.cpp).
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <sys/types.h>

namespace salbench {

// Throws StorageError with errno's reason: the system has none left.
[[noreturn]] void fail_for_lack(const char* of);

bool commands_are_ended();  // by end_commands

inline constexpr std::chrono::seconds kCommandGrace(2);  // from one way to end it to the next, harder one

class Pipe {
 public:
  Pipe();  // throws StorageError
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe();

  int reading() const { return ends_[kReading]; }  // -1: closed
  int writing() const { return ends_[kWriting]; }
  void close_reading() { close(kReading); }
  void close_writing() { close(kWriting); }

 private:
  enum End : std::uint8_t { kReading, kWriting };
  void close(End end);

  int ends_[2] = {-1, -1};
};

// Finds a line in text that comes in pieces, whatever else it holds.
class LineFinder {
 public:
  bool find(std::string_view piece, std::string_view line);  // whether the line has ended in this piece

 private:
  std::string current_;
};

// `/bin/sh -c command` in a folder, as the leader of a group. When the object is gone, so is the group.
class ProcessGroup {
 public:
  // One that serves reads lines, and its answers are told from its errors.
  enum class Serves : std::uint8_t { no, yes };
  enum class Event : std::uint8_t { ended, answered, late };
  using Clock = std::chrono::steady_clock;

  // Throws StorageError.
  ProcessGroup(const std::string& command, const std::filesystem::path& folder, Serves serves);
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;
  ~ProcessGroup();

  // False if it has left so many lines unread that there is no room. What it printed before is forgotten.
  bool tell(const std::string& line);
  void tell_no_more() { lines_->close_writing(); }

  bool has_ended();
  // Waits until the shell has ended, or the answer is printed as a line, if it is waited for, and takes in
  // what is printed meanwhile. Late at the deadline, or, if the flag counts, when the program is asked to
  // end.
  Event wait(Clock::time_point deadline, bool until_asked_to_end, std::string_view answer = {});
  void terminate();  // SIGTERM, and a little time

  // The last lines that it printed, as one line of text; of one that serves, those beside its answers, and
  // then those of its standard error.
  std::string said() const;
  std::string failure() const;  // why it did not succeed, empty if it did; after it has ended

 private:
  static constexpr std::chrono::milliseconds kFirstLook{2};

  void send(int signal) const;
  void wait_for_output(Clock::time_point deadline);
  bool take_in(std::string_view answer);
  template <class Each>
  static void read_from(Pipe& pipe, std::string& kept, const Each& each);

  Pipe output_;                          // what it prints; of one that serves, its standard error
  std::optional<Pipe> answers_, lines_;  // standard output and input of one that serves
  LineFinder finder_;
  pid_t group_ = -1;
  std::chrono::milliseconds look_ = kFirstLook;
  // The ends of what it prints: two, because nobody knows in which order it wrote into two pipes.
  std::string kept_output_, kept_answers_;
  std::string answer_;  // the last one that was waited for
  siginfo_t info_ = {};
};

// From now; decades at most, because longer ones overflow the clock.
ProcessGroup::Clock::time_point deadline_after(std::chrono::duration<double> timeout);

// One line of text for a command that was not done in time.
std::string too_late(std::chrono::duration<double> timeout, const ProcessGroup& group);

}  // namespace salbench
