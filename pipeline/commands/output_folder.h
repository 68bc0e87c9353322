// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run's results. Two runs that write to it at the same time leave whole files of either.
#pragma once

#include <filesystem>
#include <string>

namespace salbench {

// Makes the folder, and tells in it that a run is under way. record: what the run can be repeated by. Throws
// StorageError, and ConfigError where files of a run's names are of no run.
void begin_results(const std::filesystem::path& folder, const std::string& record);

}  // namespace salbench
