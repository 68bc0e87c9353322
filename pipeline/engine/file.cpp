// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/file.h"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

FileData read(const File& file) {
  if (file.read) return (*file.read)();
  std::string text = read_file(file.place, kMaxItemBytes);
  return {file_digest(text), std::move(text)};
}

FileData read_now(const File& file) {
  FileData data;
  try {
    data = read(file);
  } catch (const InputError& error) {
    data.error = error.what();
  }
  return data;
}

}  // namespace

void look(File& file, FileData* data) {
  if (file.is_read && data == nullptr) return;
  FileData now = read_now(file);
  file.digest = now.digest;
  file.is_read = true;
  if (data != nullptr) *data = std::move(now);
}

std::vector<FileData> read_again(std::span<const File> files) {
  std::vector<FileData> all;
  for (const File& file : files) {
    all.push_back(read_now(file));
    const std::optional<Digest>& now = all.back().digest;
    if (file.digest && now && now != file.digest)
      spdlog::warn("{}: changed since this run was planned; the results are of what it holds now",
                   file.place);
  }
  return all;
}

std::vector<FileData> read_all(std::span<const File> files) {
  std::vector<FileData> all;
  for (const File& file : files) all.push_back(read(file));
  return all;
}

std::vector<FileData> read_unchanged(std::span<const File> files, const Digests& digests) {
  std::vector<FileData> all = read_all(files);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (all[i].digest != digests[i])
      throw InputError(fmt::format("{}: changed since this run was planned; run it again", files[i].place));
  return all;
}

}  // namespace salbench
