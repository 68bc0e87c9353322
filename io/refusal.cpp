// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/refusal.h"

#include <filesystem>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {

std::string refusal_text(const std::system_error& refusal) {
  const auto* of_file = dynamic_cast<const std::filesystem::filesystem_error*>(&refusal);
  if (of_file != nullptr)
    return fmt::format("{}: {}", of_file->path1().string(), system_reason(refusal.code().value()));
  if (refusal.code() == std::errc::resource_unavailable_try_again)
    return fmt::format(
        "the system starts no more threads: use fewer {}, or raise its limits (ulimit -u, ulimit -v)",
        as_option("threads"));
  return refusal.what();
}

}  // namespace salbench
