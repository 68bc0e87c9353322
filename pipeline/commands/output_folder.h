// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run's results. One call at a time writes to it, be it a run or the Python package.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <utility>

#include "io/descriptor.h"

namespace salbench {

class OutputFolder {
 public:
  // Makes the folder, and waits for the call that writes to it, unless `stop` comes first. Throws
  // StorageError, and ConfigError for a folder that another run of this process writes to, which may wait for
  // this one, or where files of a run's names are of no run.
  OutputFolder(const std::filesystem::path& folder, const std::atomic<bool>& stop);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  bool is_held() const { return is_held_; }  // else it was stopped
  // Tells in it that a run is under way. record: what the run can be repeated by.
  void begin(const std::string& record) const;

 private:
  void require_own() const;

  std::filesystem::path path_;
  Descriptor folder_;
  std::pair<dev_t, ino_t> identity_ = {};
  bool is_held_ = false;
};

}  // namespace salbench
