// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/output_folder.h"

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/commands/conclude.h"
#include "pipeline/config/section.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 1U << 16U;  // of run.yaml: its first key stands behind remarks of the data set

std::string advice() { return "choose another with " + as_option("out"); }

void require_own(const fs::path& folder) {
  if (size_of_file(folder / kRecord)) {
    if (!is_record_text(read_head(folder / kRecord, kHead)))
      throw ConfigError(fmt::format("{}: is no record of a run, and one would take its place; {}",
                                    (folder / kRecord).string(), advice()));
    return;
  }
  for (const std::string& name : files_of_scores())
    if (std::error_code none; fs::exists(folder / name, none))
      throw ConfigError(fmt::format("{}: has {}, and no {}, so it is of no run, which would replace it; {}",
                                    folder.string(), name, kRecord, advice()));
}

}  // namespace

void begin_results(const fs::path& folder, const std::string& record) {
  make_folder(folder, advice());
  require_own(folder);
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / kRecord, record);
}

}  // namespace salbench
