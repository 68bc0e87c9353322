// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/cloud_file.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/ply_header.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct Format {
  std::string_view extension;
  PointCloud (*parse)(std::string_view, std::string_view);
};

constexpr std::array kFormats = {Format{".ply", parse_ply_cloud}, Format{".pcd", parse_pcd},
                                 Format{".xyz", parse_xyz}};

const Format* format_of(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  for (const Format& format : kFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

bool announces_faces(std::string_view bytes) try {
  TextScanner in(bytes, "", '\0', LineEnds::as_first);
  const ply::Header header = ply::read_header(in);
  const ply::Element* face = header.find("face");
  return (face != nullptr && face->count > 0) || header.find("tristrips") != nullptr;
} catch (const InputError&) {
  return true;
}

}  // namespace

bool has_cloud_extension(const std::filesystem::path& path) { return format_of(path) != nullptr; }

bool has_shape_extension(const std::filesystem::path& path) {
  return has_mesh_extension(path) || has_cloud_extension(path);
}

bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr && (format->extension != ".ply" || !announces_faces(bytes));
}

PointCloud parse_cloud(std::string_view bytes, const std::filesystem::path& path) {
  const Format* format = format_of(path);
  if (format == nullptr)
    throw InputError(
        fmt::format("{}: is not named as a point cloud: convert it to .ply, .pcd or .xyz", path.string()));
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty, copy it again", path.string()));
  return format->parse(bytes, path.string());
}

}  // namespace salbench
