// SPDX-License-Identifier: GPL-3.0-or-later
#include <sstream>
#include <string>

#include "pipeline/rules/config.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "tests/fuzz/message.h"
#include "tests/fuzz/targets.h"

namespace salbench {
namespace {

std::string read_and_written(const std::string& yaml, const std::string& file) {
  return config_yaml(read_config(Section::from_text(yaml, file), "name"));
}

}  // namespace

void fuzz_config(std::string_view bytes) {
  const std::string file = "folder/file.yaml";
  std::string written;
  try {
    written = read_and_written(std::string(bytes), file);
  } catch (const ConfigError& error) {
    CHECK_GT(std::string_view(error.what()).size(), std::size_t{0});
    std::istringstream errors(error.what());  // a line each
    for (std::string line; std::getline(errors, line);) check_message(line, file);
    return;
  }
  CHECK_EQ(read_and_written(written, "written by salbench"), written);
}

}  // namespace salbench
