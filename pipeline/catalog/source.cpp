// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/source.h"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// Brings digest and error up to date.
SourceData read_now(SourceFile& file) {
  try {
    SourceData data = file.read();
    file.digest = data.digest;
    file.error.clear();
    return data;
  } catch (const InputError& error) {
    file.digest.reset();
    file.error = error.what();
    return {};
  }
}

}  // namespace

SourceFile source_file(std::string name, const std::filesystem::path& path, SourceData* data) {
  const auto read = [path]() -> SourceData {
    std::string text = read_file(path, kMaxItemBytes);
    return {file_digest(text), std::move(text)};
  };
  return source_file(std::move(name), path.string(), read, data);
}

SourceFile source_file(std::string name, std::string place, std::function<SourceData()> read,
                       SourceData* data) {
  SourceFile file{std::move(name), std::move(place), std::move(read)};
  SourceData now = read_now(file);
  if (data != nullptr) *data = std::move(now);
  return file;
}

SourceFile mesh_file_of(const DatasetItem& item, SourceData* data) {
  return source_file("mesh file " + lower_case_extension(item.mesh), item.mesh, data);
}

std::vector<SourceData> read_again(SourceFiles& files) {
  std::vector<SourceData> data;
  for (SourceFile& file : files) {
    const std::optional<Digest> planned = file.digest;
    data.push_back(read_now(file));
    if (planned && file.digest && file.digest != planned)
      spdlog::warn("{}: changed since this run was planned; the results are of what it holds now",
                   file.place);
  }
  return data;
}

std::vector<SourceData> read_unchanged(const SourceFiles& files) {
  std::vector<SourceData> data;
  for (const SourceFile& file : files) {
    data.push_back(file.read());
    if (data.back().digest != file.digest)
      throw InputError(fmt::format("{}: changed since this run was planned; run it again", file.place));
  }
  return data;
}

}  // namespace salbench
