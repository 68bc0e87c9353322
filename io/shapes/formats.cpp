// SPDX-License-Identifier: GPL-3.0-or-later
// Formats of shapes, a row each.
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct Format {
  std::string_view extension;
  Mesh (*mesh)(std::string_view, std::string_view, PolygonCounts*) = nullptr;  // where it can hold one
  PointCloud (*cloud)(std::string_view, std::string_view) = nullptr;
  bool (*announces_faces)(std::string_view) = nullptr;  // where it can hold both
};

constexpr std::array kFormats = {
    Format{".off", parse_off},
    Format{".obj", parse_obj},
    Format{".ply", parse_ply, parse_ply_cloud, ply_announces_faces},
    Format{".pcd", nullptr, parse_pcd},
    Format{".xyz", nullptr, parse_xyz},
};

// The reader for a file with this extension; null if such files do not hold that kind of shape.
template <class Reader>
Reader reader_of(const std::filesystem::path& path, Reader Format::*reader) {
  const std::string extension = lower_case_extension(path);
  for (const Format& format : kFormats)
    if (format.extension == extension) return format.*reader;
  return nullptr;
}

template <class Reader>
Reader reader_of(std::string_view bytes, const std::filesystem::path& path, Reader Format::*reader,
                 std::string_view shape) {
  const Reader found = reader_of(path, reader);
  if (found == nullptr) {
    std::vector<std::string_view> known;
    for (const Format& format : kFormats)
      if (format.*reader != nullptr) known.push_back(format.extension);
    throw InputError(fmt::format("{}: is not named as a {}: convert it to {} or {}", path.string(), shape,
                                 fmt::join(known.begin(), known.end() - 1, ", "), known.back()));
  }
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty, copy it again", path.string()));
  return found;
}

}  // namespace

bool has_mesh_extension(const std::filesystem::path& path) {
  return reader_of(path, &Format::mesh) != nullptr;
}

bool has_cloud_extension(const std::filesystem::path& path) {
  return reader_of(path, &Format::cloud) != nullptr;
}

bool has_shape_extension(const std::filesystem::path& path) {
  return has_mesh_extension(path) || has_cloud_extension(path);
}

bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path) {
  const auto announces_faces = reader_of(path, &Format::announces_faces);
  return has_cloud_extension(path) && (announces_faces == nullptr || !announces_faces(bytes));
}

Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& path, PolygonCounts* counts) {
  return reader_of(bytes, path, &Format::mesh, "mesh")(bytes, path.string(), counts);
}

Mesh read_mesh(const std::filesystem::path& path) { return parse_mesh(read_file(path, kMaxItemBytes), path); }

PointCloud parse_cloud(std::string_view bytes, const std::filesystem::path& path) {
  return reader_of(bytes, path, &Format::cloud, "point cloud")(bytes, path.string());
}

}  // namespace salbench
