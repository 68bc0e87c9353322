// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "io/hdf5/head.h"
#include "io/hdf5/one_form.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/shape_file.h"
#include "io/shapes/values_file.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/geometry/mesh_check.h"
#include "stages/geometry/point_cloud.h"
#include "tests/fuzz/message.h"
#include "tests/fuzz/targets.h"
#include "tests/support/image_head.h"

namespace salbench {
namespace {

constexpr std::string_view kFile = "folder/file";

// Result of the reader; nullopt if it rejects the bytes properly.
template <class Read>
auto read_or_refuse(Read read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const InputError& error) {
    check_message(error.what(), kFile);
    return {};
  }
}

void check_indices_and_coordinates(const Mesh& mesh) {
  for (const Vec3& vertex : mesh.vertices) CHECK_EQ(vertex.allFinite(), true);
  for (const Triangle& face : mesh.faces) {
    for (const std::int32_t index : face) {
      CHECK_LE(0, index);
      CHECK_LT(static_cast<std::size_t>(index), mesh.vertices.size());
    }
  }
}

void check_inverse(const Mesh& mesh) {
  const Mesh back = parse_ply(ply_of({.points = mesh.vertices, .faces = mesh.faces}), "written by salbench");
  CHECK_EQ(back.vertices == mesh.vertices, true);
  CHECK_EQ(back.faces == mesh.faces, true);
}

void check_faces_are_counted(const Mesh& mesh) {
  try {
    const CheckedMesh checked = check_mesh(mesh);
    const auto n_faces = static_cast<std::int64_t>(mesh.faces.size());
    CHECK_EQ(checked.mesh.vertices == mesh.vertices, true);
    CHECK_EQ(static_cast<std::int64_t>(checked.mesh.faces.size()) + checked.report.degenerate_faces +
                 checked.report.duplicate_faces,
             n_faces);
    for (const std::string& warning : warnings(checked.report)) check_one_line(warning);
  } catch (const InputError& error) {
    check_one_line(error.what());
  }
}

void check_mesh_reader(Mesh (*parse)(std::string_view, std::string_view, PolygonCounts*),
                       std::string_view bytes) {
  const auto mesh = read_or_refuse([&] { return parse(bytes, kFile, nullptr); });
  if (!mesh) return;
  check_indices_and_coordinates(*mesh);
  check_inverse(*mesh);
  check_faces_are_counted(*mesh);
}

void check_cloud_is_checked(const PointCloud& cloud) {
  try {
    const CheckedCloud checked = check_cloud(cloud);
    CHECK_EQ(checked.cloud.size_in_file(), cloud.points.size());
    CHECK_LE(kFewestPoints, checked.cloud.points.size());
    for (const Vec3& point : checked.cloud.points) CHECK_EQ(point.allFinite(), true);
    for (const Vec3& normal : checked.cloud.normals) CHECK_LT(std::abs(normal.norm() - 1), 1e-12);
    for (const std::string& warning : checked.warnings) check_one_line(warning);
    const CheckedCloud again = check_cloud({checked.cloud.points, checked.cloud.normals});
    CHECK_EQ(again.cloud.points == checked.cloud.points, true);
    CHECK_EQ(again.cloud.normals == checked.cloud.normals, true);
  } catch (const InputError& error) {
    check_one_line(error.what());
  }
}

std::size_t count_words(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::size_t n = 0;
  for (std::string word; words >> word;) ++n;
  return n;
}

}  // namespace

void fuzz_off(std::string_view bytes) { check_mesh_reader(parse_off, bytes); }
void fuzz_obj(std::string_view bytes) { check_mesh_reader(parse_obj, bytes); }
void fuzz_ply(std::string_view bytes) { check_mesh_reader(parse_ply, bytes); }

void fuzz_ply_cloud(std::string_view bytes) {
  const auto cloud = read_or_refuse([&] { return parse_ply_cloud(bytes, kFile); });
  if (!cloud) return;
  CHECK_EQ(cloud->normals.empty() || cloud->normals.size() == cloud->points.size(), true);
  CHECK_EQ(cloud->dropped.empty(), true);
  if (cloud->viewpoint) CHECK_EQ(cloud->viewpoint->allFinite(), true);
  check_cloud_is_checked(*cloud);
}

void fuzz_val(std::string_view bytes) {
  const auto read = [&](std::size_t n_vertices) {
    return read_or_refuse([&] { return parse_values(bytes, kFile, {n_vertices}); });
  };
  const std::size_t n_vertices = count_words(bytes);  // one value per line, at most one per word
  const auto values = read(n_vertices);
  if (!values) return;
  CHECK_EQ(values->size(), n_vertices);
  for (const double value : *values) CHECK_EQ(std::isfinite(value), true);
  CHECK_EQ(read(n_vertices + 1).has_value(), false);
}

void fuzz_pid(std::string_view bytes) {
  const auto read = [&](std::size_t n_vertices) {
    return read_or_refuse([&] { return parse_picks(bytes, kFile, {n_vertices}); });
  };
  constexpr std::size_t kVertices = 20'000;
  const auto picks = read(kVertices);
  if (!picks || picks->empty()) return;
  for (const std::int32_t pick : *picks) {
    CHECK_LE(0, pick);
    CHECK_LT(static_cast<std::size_t>(pick), kVertices);
  }
  const auto last = static_cast<std::size_t>(*std::max_element(picks->begin(), picks->end()));
  CHECK_EQ(read(last + 1) == picks, true);
  CHECK_EQ(read(last).has_value(), false);
}

void fuzz_head(std::string_view bytes) {
  const auto given = std::as_bytes(std::span(bytes));
  const Bytes image = vouched_for({given.begin(), given.end()});
  const auto content = content_by_head(image);
  if (!content) return;
  for (const Array& array : content->arrays)
    CHECK_EQ(std::visit([](const auto& values) { return values.size(); }, array.values), array.count());
  read_or_refuse([&] {
    return shape_in_form({reinterpret_cast<const char*>(image.data()), image.size()}, kFile);
  });
}

}  // namespace salbench
