// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/mesh_file.h"

#include <array>
#include <string>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct MeshFormat {
  std::string_view extension;
  Mesh (*parse)(std::string_view, std::string_view, PolygonCounts*);
};

constexpr std::array kMeshFormats = {MeshFormat{".off", parse_off}, MeshFormat{".obj", parse_obj},
                                     MeshFormat{".ply", parse_ply}};

const MeshFormat* mesh_format_of(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  for (const MeshFormat& format : kMeshFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

}  // namespace

bool has_mesh_extension(const std::filesystem::path& path) { return mesh_format_of(path) != nullptr; }

Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& path, PolygonCounts* counts) {
  const MeshFormat* format = mesh_format_of(path);
  if (format == nullptr)
    throw InputError(
        fmt::format("{}: is not named as a mesh: convert it to .off, .obj or .ply", path.string()));
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty, copy it again", path.string()));
  return format->parse(bytes, path.string(), counts);
}

Mesh read_mesh(const std::filesystem::path& path) { return parse_mesh(read_file(path, kMaxItemBytes), path); }

}  // namespace salbench
