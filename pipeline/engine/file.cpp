// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/file.h"

#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

std::mutex first_reading;  // shared by all files; held briefly

FileData read_now(const File& file) {
  if (file.read_with) return (*file.read_with)();
  std::string text = read_file(file.place, kMaxItemBytes);
  return {file_digest(text), std::move(text)};
}

}  // namespace

bool File::is_known() const {
  const std::lock_guard lock(first_reading);
  return is_read;
}

std::optional<Digest> File::digest() {
  try {
    if (!is_known()) read();
  } catch (const InputError&) {  // reported by the job that reads it
  }
  const std::lock_guard lock(first_reading);
  is_read = true;
  return first_digest;
}

FileData File::read() {
  FileData data = read_now(*this);
  const std::lock_guard lock(first_reading);
  if (!std::exchange(is_read, true)) first_digest = data.digest;
  if (first_digest != data.digest)
    throw InputError(fmt::format("{}: changed since this run was planned; run it again", place));
  return data;
}

std::vector<FileData> read_files(std::span<File> files) {
  std::vector<FileData> all;
  for (File& file : files) all.push_back(file.read());
  return all;
}

}  // namespace salbench
