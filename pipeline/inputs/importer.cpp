// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/importer.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/digest.h"
#include "io/file.h"
#include "pipeline/inputs/inputs.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// True if the importer read this file: the shape's source_files have a line "DIGEST  PATH" of it, with its
// path below the data set.
bool has_read(const ShapeInForm& shape, const fs::path& root, const std::string& path, const Digest& digest) {
  const auto plain = [](const fs::path& place) { return fs::absolute(place).lexically_normal(); };
  const std::string line =
      fmt::format("\n{}  {}\n", digest.hex(), plain(path).lexically_relative(plain(root)).string());
  return std::ranges::any_of(shape.about, [&](const auto& about) {
    return about.first == "source_files" && ("\n" + about.second).find(line) != std::string::npos;
  });
}

const char* kind_name(bool is_cloud) { return is_cloud ? "point cloud" : "mesh"; }

// Reads an HDF5 image that this version of salbench has just made.
ShapeInForm require_own(std::optional<ShapeInForm> shape, const std::string& of) {
  if (!shape) throw std::runtime_error(fmt::format("the importer's form of {} cannot be read", of));
  return std::move(*shape);
}

}  // namespace

Importer::Importer(Front front, DataImporter of) : front_(std::move(front)), of_(std::move(of)) {}

std::string Importer::asked(const std::string& what,
                            const std::vector<std::pair<std::string, std::string>>& of) const {
  return answering(front_.read, "an import")({what, of});
}

ShapeInForm Importer::item(const Files& files) const {
  const DatasetItem& item = item_of(files.source);
  const std::string bytes = asked("item", {{"layout", of_.layout}, {"root", of_.root}, {"item", item.name}});
  ShapeInForm shape = require_own(shape_in_form(bytes, item.mesh), item.name);
  if (shape.is_cloud != item.imported->known.is_cloud)
    throw std::runtime_error(
        fmt::format("the importer's form of {} is of another kind than its list says", item.name));
  for (std::size_t i = 0; i < files.data.size(); ++i)
    if (const std::string& path = item.imported->files[i].path;
        !has_read(shape, of_.root, path, xxh128(files.data[i].text())))
      throw InputError(fmt::format("{}: changed while it was imported; run it again", path));
  return shape;
}

// A file that another program wrote is first rewritten as salbench writes them.
std::optional<ShapeInForm> Importer::form_in(const Files& files, bool with_truth) const {
  const DatasetItem& item = item_of(files.source);
  if (!item.is_in_form()) return {};
  constexpr std::string_view kNoView = "/";  // no view has such a name
  const std::string& path = item.mesh;
  const std::string_view view = with_truth ? std::string_view(item.view) : kNoView;
  auto shape = shape_in_form(files.data[0].text(), path, view);
  if (!shape) {
    const std::string own = asked("rewrite", {{"path", path}});
    require_form_of(item.shape_name(), own, path);
    if (file_digest(read_file(path, kMaxItemBytes)) != files.data[0].digest)
      throw InputError(fmt::format("{}: changed while it was read; run it again", path));
    shape = require_own(shape_in_form(own, path, view), path);
  }
  if (shape->is_cloud != item.imported->known.is_cloud)
    throw InputError(
        fmt::format("{}: is a {}, and index.csv says that it is a {}: put the right file there, "
                    "or import the set again",
                    path, kind_name(shape->is_cloud), kind_name(!shape->is_cloud)));
  return shape;
}

ScalarField values_in_bytes(const std::string& bytes, const std::string& about) {
  ScalarField values(bytes.size() / sizeof(double));
  if (values.size() * sizeof(double) != bytes.size())
    throw std::runtime_error(fmt::format("the importer's values of {} cannot be read", about));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace salbench
