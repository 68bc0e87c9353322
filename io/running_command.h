// SPDX-License-Identifier: GPL-3.0-or-later
// A command at work, for what runs it (process.cpp, serving_command.cpp): what it prints, and when it ends.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "io/kept_command.h"
#include "io/process.h"

namespace salbench {

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

// `/bin/sh -c command` in a folder. When the object is gone, so are all processes that the command started.
class RunningCommand {
 public:
  // One that serves reads lines, and its answers are told from its errors.
  enum class Serves : std::uint8_t { no, yes };
  enum class Event : std::uint8_t { ended, answered, late };
  using Clock = std::chrono::steady_clock;

  // Throws StorageError.
  RunningCommand(const std::string& command, const std::filesystem::path& folder, Serves serves);

  // False if it has left so many lines unread that there is no room. What it printed before is forgotten.
  bool tell(const std::string& line);
  std::size_t unread() const;  // bytes of what it was told
  void tell_no_more() { lines_->close_writing(); }

  bool has_ended() { return kept_.end().has_value(); }
  // Waits until it has ended, or the answer is printed as a line, if it is waited for, and takes in what is
  // printed meanwhile. Late at the deadline, or, if the flag counts, when the program is asked to end.
  Event wait(Clock::time_point deadline, bool until_asked_to_end, std::string_view answer = {});
  void terminate();  // SIGTERM, and a little time

  // The last lines that it printed, as one line of text; of one that serves, those beside its answers, and
  // then those of its standard error.
  std::string printed() const;
  std::string said() const { return said_of(printed()); }
  // Why it did not succeed, empty if it did; after it has ended. Throws StorageError if the system had no
  // process for it.
  std::string failure();
  int status();  // 128 + the signal that killed it; after it has ended

 private:
  void wait_for_event(Clock::time_point deadline, bool until_asked_to_end);
  bool take_in(std::string_view answer);

  Pipe output_;                          // what it prints; of one that serves, its standard error
  std::optional<Pipe> answers_, lines_;  // standard output and input of one that serves
  KeptCommand kept_;
  LineFinder finder_;
  // The ends of what it prints: two, because nobody knows in which order it wrote into two pipes.
  std::string kept_output_, kept_answers_;
  std::string answer_;  // the last one that was waited for
};

// From now; decades at most, because longer ones overflow the clock.
RunningCommand::Clock::time_point deadline_after(std::chrono::duration<double> timeout);

// One line of text for a command that was not done in time.
std::string too_late(std::chrono::duration<double> timeout, const RunningCommand& command);

}  // namespace salbench
