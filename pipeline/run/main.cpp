// SPDX-License-Identifier: GPL-3.0-or-later
// salbench-engine CONFIG DATA CACHE OUT [THREADS]: the paper's benchmark without Python, and the example of
// the C++ interface. It supports the layouts schelling, folder and hdf5, runs the flow graph with the models
// of the table, resumes from the cache, and writes tables of scores and means with the run's record.
// Conclusions, reports and user models need the command salbench.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/config/option_text.h"
#include "pipeline/run/run.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

enum ExitStatus {
  kAllDone = 0,
  kSomeFailed = 1,
  kUnusableArguments = 2,
  kUnusableStorage = 3,
  kDefect = 70,
  kInterrupted = 130
};

// Signal handlers may access lock-free atomics.
std::atomic<bool> asked_to_stop = false;
static_assert(std::atomic<bool>::is_always_lock_free);

// First signal: the run ends in order, with tables of the finished part. Second signal: the program ends at
// once.
void on_signal(int signal) {
  asked_to_stop = true;
  std::signal(signal, SIG_DFL);
}

int thread_count(const std::string& text) {
  int threads = 0;
  if (!parse_option(text, threads) || threads < 1 || threads > kMostThreads)
    throw ConfigError(fmt::format("THREADS is {}: must be a whole number from 1 to {}", text, kMostThreads));
  return threads;
}

// Summary of a run that has ended.
std::string text_of(Session& session) {
  std::string text = aligned(means_of(session));
  return fmt::format("{}\n{}: {} artefacts computed, results in {}\n", text, session.setup.inputs.text(),
                     session.resolver.computed(), session.setup.output.string());
}

ExitStatus run(const Request& request, int threads) {
  Session session(request, {}, std::make_unique<NoProgress>(), asked_to_stop);
  run_and_write(session, threads);
  if (session.stop) return kInterrupted;
  std::fputs(text_of(session).c_str(), stdout);
  if (session.resolver.failures().empty() && session.setup.inputs.errors.empty()) return kAllDone;
  for (const Failure& failure : session.resolver.failures())
    if (failure.defect) return kDefect;
  return kSomeFailed;
}

// Reports every error as one line on standard error, with an exit status that tells who has to act.
ExitStatus run_program(int argc, char** argv) {
  const auto ended = [](ExitStatus status, const std::string& why) {
    spdlog::error("{}", why);
    return status;
  };
  if (argc < 5 || argc > 6) {
    std::fputs("Usage: salbench-engine CONFIG DATA CACHE OUT [THREADS]\n", stderr);
    return kUnusableArguments;
  }
  try {
    const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const Request request{.config = argv[1], .data = argv[2], .cache = argv[3], .output = argv[4]};
    return run(request, argc == 6 ? thread_count(argv[5]) : all);
  } catch (const StorageError& error) {
    return ended(kUnusableStorage, error.what());
  } catch (const std::system_error& error) {
    return ended(kUnusableStorage, refusal_text(error));
  } catch (const ConfigError& error) {
    return ended(kUnusableArguments, error.what());
  } catch (const InputError& error) {
    return ended(kUnusableArguments, error.what());
  } catch (...) {
    return ended(kDefect, current_defect());
  }
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("salbench"));
  spdlog::set_pattern("%^%l%$: %v");
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond a file size limit then fails, as on a full disk
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, salbench::on_signal);
  return salbench::run_program(argc, argv);
}
