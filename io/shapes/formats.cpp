// SPDX-License-Identifier: GPL-3.0-or-later
// Table of mesh formats.
#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct Format {
  std::string_view extension;
  Mesh (*read)(std::string_view, std::string_view, PolygonCounts*);
};
constexpr std::array kFormats = {Format{".off", parse_off}, Format{".obj", parse_obj},
                                 Format{".ply", parse_ply}};

const Format* format_of(const std::filesystem::path& path) {
  const auto* const found = std::ranges::find(kFormats, lower_case_extension(path), &Format::extension);
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

bool has_mesh_extension(const std::filesystem::path& path) { return format_of(path) != nullptr; }

bool has_cloud_extension(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".ply" || extension == ".pcd" || extension == ".xyz";
}

bool has_shape_extension(const std::filesystem::path& path) {
  return has_mesh_extension(path) || has_cloud_extension(path);
}

bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path) {
  return has_cloud_extension(path) && (!has_mesh_extension(path) || !ply_announces_faces(bytes));
}

Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& path, PolygonCounts* counts) {
  const Format* format = format_of(path);
  if (format == nullptr)
    throw InputError(
        fmt::format("{}: is not named as a mesh: convert it to .off, .obj or .ply", path.string()));
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty, copy it again", path.string()));
  return format->read(bytes, path.string(), counts);
}

Mesh read_mesh(const std::filesystem::path& path) { return parse_mesh(read_file(path, kMaxItemBytes), path); }

}  // namespace salbench
