// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/source.h"

#include <algorithm>
#include <cctype>
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

SourceFile source_file(std::string name, const std::filesystem::path& path) {
  return source_file(std::move(name), path.string(), [path]() -> SourceData {
    std::string text = read_file(path);
    return {file_digest(text), std::move(text)};
  });
}

SourceFile source_file(std::string name, std::string place, std::function<SourceData()> read) {
  SourceFile file{std::move(name), std::move(place), std::move(read)};
  read_now(file);
  return file;
}

SourceFile mesh_file_of(const DatasetItem& item) {
  std::string extension = item.mesh.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return source_file("mesh file " + extension, item.mesh);
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
