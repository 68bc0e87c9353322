// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/item_reader.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "pipeline/inputs/inputs.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

const char* kind_name(bool is_cloud) { return is_cloud ? "point cloud" : "mesh"; }

// The front opens files itself; they must still match the digest in the key.
void require_unchanged(const std::string& path, const FileData& data) {
  if (file_digest(read_file(path, kMaxItemBytes)) != data.digest)
    throw InputError(fmt::format("{}: changed while it was read; run it again", path));
}

// The front has checked a file of another program. `wanted`: the view to keep.
void keep_view(ShapeInForm& shape, std::string_view wanted) {
  std::erase_if(shape.truths, [&](const TruthInForm& truth) { return truth.view != wanted; });
}

}  // namespace

ItemReader::ItemReader(Front front, ReadItem read) : front_(std::move(front)), read_(std::move(read)) {}

ShapeInForm ItemReader::read(const Files& files) const {
  const Item& item = item_of(files.source);
  ShapeInForm shape = read_(item);
  if (shape.is_cloud != item.is_cloud)
    throw InputError(fmt::format("{}: is a {}, and its Item says that it is a {}: give kind=\"{}\"",
                                 item.name, kind_name(shape.is_cloud), kind_name(item.is_cloud),
                                 shape.is_cloud ? "cloud" : "mesh"));
  for (std::size_t i = 0; i < item.files.size(); ++i) require_unchanged(item.files[i], files.data[i]);
  return shape;
}

ShapeInForm ItemReader::shape(const Files& files, bool is_cloud) const {
  if (auto in_form = form(files, false)) return std::move(*in_form);
  const std::string& path = item_of(files.source).file;
  ShapeInForm shape{.is_cloud = is_cloud};
  if (!is_cloud) {
    shape.mesh = parse_mesh(files.data[0].text(), path, &shape.polygons);
  } else if (lower_case_extension(path) == ".ply") {
    shape.cloud = parse_ply_cloud(files.data[0].text(), path);
  } else {
    shape.cloud = answering<InputError>(front_.read_cloud, path)(path);
    require_unchanged(path, files.data[0]);
  }
  return shape;
}

std::optional<ShapeInForm> ItemReader::form(const Files& files, bool with_truth) const {
  const Item& item = item_of(files.source);
  if (!item.is_in_form()) return {};
  constexpr std::string_view kNoView = "/";  // not a possible name of a view
  const std::string& path = item.file;
  const std::string_view view = with_truth ? std::string_view(item.view) : kNoView;
  auto shape = shape_in_form(files.data[0].text(), path, view);
  if (!shape) {
    shape = answering<InputError>(front_.read_form, path)(path, item.shape_name());
    require_unchanged(path, files.data[0]);
    keep_view(*shape, view);
  }
  if (shape->is_cloud != item.is_cloud)
    throw InputError(
        fmt::format("{}: is a {}, and index.csv says that it is a {}: put the right file there, "
                    "or import the set again",
                    path, kind_name(shape->is_cloud), kind_name(item.is_cloud)));
  return shape;
}

}  // namespace salbench
