// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/e2e/workspace.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "cache/layout.h"
#include "cache/recipes.h"
#include "io/digest.h"
#include "io/file.h"
#include "tests/support/cache_files.h"
#include "tests/support/toy_data.h"

namespace salbench {

namespace fs = std::filesystem;

namespace {

// Every artefact is synced, and waiting for a disk would be most of the time of these tests. scripts/test
// knows the name.
const bool kInMemory = [] {
  std::error_code error;
  fs::create_directory(SALBENCH_TEST_MEMORY, error);  // fails where there is no such memory
  return !error && ::setenv("TMPDIR", SALBENCH_TEST_MEMORY, 1) == 0;
}();

}  // namespace

Workspace::Workspace() : Workspace(kToyConfig) {}

Workspace::Workspace(std::string_view yaml) {
  configure(yaml);
  write_two_toy_items(data());
}

std::vector<std::string> Workspace::command(const std::string& verb,
                                            const std::vector<std::string>& further) const {
  std::vector<std::string> words = {SALBENCH_PROGRAM, verb, config().string()};
  const auto add_default = [&](const char* option, const std::string& value) {
    if (std::ranges::find(further, option) == further.end()) words.insert(words.end(), {option, value});
  };
  add_default("--data", data().string());
  add_default("--cache", cache().string());
  if (verb == "run" || verb == "plan") add_default("--out", out().string());
  if (verb == "run" || verb == "export") add_default("--threads", "2");
  words.insert(words.end(), further.begin(), further.end());
  return words;
}

std::unique_ptr<Claim> Workspace::claim_family(const std::string& mesh) const {
  fs::create_directories(cache());
  return claim_in(cache(), "family " + file_digest(read_file(data() / "Meshes" / (mesh + ".off"))).hex());
}

// Each try opens the file of the claims. Openings and closings take turns: the kernel merges equal events.
bool Workspace::tries_to_claim(Process& process, int times) const {
  const int watch = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  const fs::path claims = cache() / kClaimsFile;
  if (::inotify_add_watch(watch, claims.c_str(), IN_OPEN | IN_CLOSE_WRITE) < 0)
    throw std::system_error(errno, std::generic_category(), claims.string());
  int seen = 0;
  const bool tried = wait_until(process, [&] {
    inotify_event event{};  // of a file: no name follows
    while (::read(watch, &event, sizeof event) == sizeof event) seen += (event.mask & IN_OPEN) != 0 ? 1 : 0;
    return seen >= times;
  });
  ::close(watch);
  return tried;
}

std::string Workspace::results() const { return read_file(out() / "results.csv"); }
std::string Workspace::summary() const { return read_file(out() / "summary.csv"); }

std::size_t Workspace::computed() const {
  constexpr std::string_view kKey = "artefacts_computed: ";
  const std::string yaml = read_file(out() / "run.yaml");
  return std::stoul(yaml.substr(yaml.find(kKey) + kKey.size()));
}

void Workspace::forget_everything() const {
  fs::remove_all(cache());
  fs::remove_all(out());
}

std::vector<std::string> Workspace::artefacts(std::string_view stage) const {
  std::vector<std::string> lines;
  for (const KnownArtefact& artefact : artefacts_of(cache()))
    if (stage.empty() || artefact.stage == stage)
      lines.push_back(fmt::format("{}/{} {} {}", artefact.stage, artefact.label, artefact.key.hex(),
                                  artefact.content.hex()));
  std::ranges::sort(lines);
  lines.erase(std::ranges::unique(lines).begin(), lines.end());
  return lines;
}

std::vector<fs::path> Workspace::files() const { return list_segments(cache()); }

bool Workspace::reached_by(Process& process, std::size_t count, std::chrono::microseconds longer) const {
  if (!wait_until(process, [&] { return artefacts().size() >= count; })) return false;
  std::this_thread::sleep_for(longer);
  return !process.ended();
}

std::vector<fs::path> Workspace::left_over() const {
  std::vector<fs::path> files;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(cache() / "tmp", missing)) files.push_back(entry.path());
  for (const auto& entry : fs::directory_iterator(out(), missing)) {
    const fs::path end = entry.path().extension();
    if (end != ".csv" && end != ".yaml" && end != ".json") files.push_back(entry.path());
  }
  return files;
}

std::vector<std::string> lines_with(std::string_view text, std::string_view part) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> found;
  for (std::string line; std::getline(stream, line);)
    if (line.find(part) != std::string::npos) found.push_back(line);
  return found;
}

}  // namespace salbench
