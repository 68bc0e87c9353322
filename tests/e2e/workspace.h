// SPDX-License-Identifier: GPL-3.0-or-later
// A folder with a small data set, a configuration, and the cache and results of the runs over them.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cache/claim.h"
#include "tests/e2e/process.h"
#include "tests/support/temporary_folder.h"

namespace salbench {

inline constexpr const char* kMeshesOnly = "dataset: {scans: false}\nmodels: {PS: , RS: }\n";

class Workspace {
 public:
  // The meshes "1" and "2", with ground truth, evaluated by PS and RS on themselves and on coarse scans.
  Workspace();
  explicit Workspace(std::string_view yaml);

  // Names with a blank: nothing may depend on their absence.
  std::filesystem::path data() const { return folder_ / "data set"; }
  std::filesystem::path config() const { return folder_ / "toy.yaml"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }
  std::filesystem::path out() const { return folder_ / "out"; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return folder_ / name; }

  std::filesystem::path write(const std::filesystem::path& name, std::string_view text) const {
    return folder_.write(name, text);
  }
  void configure(std::string_view yaml) const { write("toy.yaml", yaml); }

  // `salbench VERB CONFIG` over these folders, as far as it takes them, with further arguments that may name
  // others.
  std::vector<std::string> command(const std::string& verb,
                                   const std::vector<std::string>& further = {}) const;
  Outcome salbench(const std::string& verb, const std::vector<std::string>& further = {}) const {
    return run_process(command(verb, further));
  }

  // The claim that the program takes on a mesh and its scans, held by the test in its place.
  std::unique_ptr<Claim> claim_family(const std::string& mesh) const;
  // Waits until work has been claimed, or tried to be claimed, so many more times; false where the process
  // ends.
  bool tries_to_claim(Process& process, int times) const;

  std::string results() const;     // the bytes of results.csv
  std::string summary() const;     // of summary.csv
  std::size_t computed() const;    // artefacts that the last run computed, by its run.yaml
  void forget_everything() const;  // removes cache and results

  // "stage/item key content" of each, sorted: what the cache says, without when it was said.
  std::vector<std::string> artefacts(std::string_view stage = {}) const;
  std::vector<std::filesystem::path> files() const;  // of the cache that hold them, by path
  // Waits until so many are stored, whatever the machine's speed, and then a little longer: what comes next
  // falls anywhere between and in the writing of them. False where the process ended before.
  bool reached_by(Process& process, std::size_t artefacts, std::chrono::microseconds longer = {}) const;
  // Everything in the cache's scratch folder, and in the output folder what is no table.
  std::vector<std::filesystem::path> left_over() const;

 private:
  TemporaryFolder folder_;
};

// The lines of a text that hold `part`.
std::vector<std::string> lines_with(std::string_view text, std::string_view part);

}  // namespace salbench
