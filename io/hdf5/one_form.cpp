// SPDX-License-Identifier: GPL-3.0-or-later
// shape/ has points, faces and normals; truth/ has the values on the points, or views/VIEW/ for separately
// scored views.
#include "io/hdf5/one_form.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "io/hdf5/form_reader.h"
#include "io/hdf5/head.h"
#include "io/hdf5/recording_form.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr const char* kForm = "salbench item";
// Files without a gaze recording keep version 2, which older programs read.
constexpr std::int64_t kFormVersion = 2, kVersionWithGaze = 3;
constexpr const char* kNumber = "number";
constexpr std::string_view kViewGroups = "views/";

// --- writing ----------------------------------------------------------------------------------------------

void add_shape(Arrays& arrays, const ShapeInForm& shape) {
  arrays.push_back(triples("shape/points", shape.is_cloud ? shape.cloud.points : shape.mesh.vertices,
                           kSourceLength, "x, y and z of the points, or of the vertices of the mesh"));
  if (!shape.is_cloud)
    arrays.push_back(triples("shape/faces", shape.mesh.faces, kNumber,
                             "0-based points at the corners of the triangles, in the order of the source"));
  if (const PolygonCounts& counts = shape.polygons; counts.split > 0)
    arrays.push_back(column<std::int64_t>("shape/polygons", {counts.split, counts.concave}, kNumber,
                                          "polygons of the source that were split, those of them that were "
                                          "concave"));
  const PointCloud& cloud = shape.cloud;
  if (!cloud.normals.empty())
    arrays.push_back(triples("shape/normals", cloud.normals, "1", "unit normals of the points"));
  if (const auto& place = cloud.viewpoint)
    arrays.push_back(column("shape/viewpoint", std::vector<double>(place->begin(), place->end()),
                            kSourceLength, "x, y and z from where the points were seen"));
  if (!cloud.dropped.empty())
    arrays.push_back(column("shape/left_out", cloud.dropped, kNumber,
                            "0-based numbers in the source of points that are left out here"));
}

std::string group_of(std::string_view view) {
  return view.empty() ? "truth/" : fmt::format("{}{}/", kViewGroups, view);
}

void add_truth(Arrays& arrays, const TruthInForm& truth) {
  const std::string group = group_of(truth.view);
  const GroundTruth& known = truth.truth;
  if (!known.saliency.empty())
    arrays.push_back(column(group + "saliency", known.saliency, "1", "value of each point; NaN: not seen"));
  if (!known.viewers.empty()) {
    std::vector<double> all;
    for (const ScalarField& viewer : known.viewers) all.insert(all.end(), viewer.begin(), viewer.end());
    arrays.push_back({.name = group + "viewers",
                      .shape = {known.viewers.size(), known.viewers[0].size()},
                      .values = std::move(all),
                      .unit = "1",
                      .description = "row per viewer: value of each point; NaN: not seen"});
  }
  if (!known.picks.empty()) {
    std::vector<std::int32_t> all, counts;
    for (const auto& picks : known.picks) {
      all.insert(all.end(), picks.begin(), picks.end());
      counts.push_back(static_cast<std::int32_t>(picks.size()));
    }
    arrays.push_back(column(group + "picks", std::move(all), kNumber,
                            "0-based points that people picked, one participant after the other"));
    arrays.push_back(
        column(group + "picks_of", std::move(counts), kNumber, "how many of these each participant picked"));
  }
  if (!truth.face_values.empty())
    arrays.push_back(column(group + "faces", truth.face_values, "1",
                            "value of each face of shape/faces, as published; NaN: not seen"));
}

// --- reading ----------------------------------------------------------------------------------------------

std::vector<std::vector<std::int32_t>> picks_in(const FormReader& in, const std::string& group,
                                                std::size_t n) {
  const auto& all = in.read<std::int32_t>(group + "picks", 0);
  const auto& counts = in.read<std::int32_t>(group + "picks_of", 0);
  in.check_indices(group + "picks", all, n);
  const bool any_negative = std::ranges::any_of(counts, [](std::int32_t count) { return count < 0; });
  if (any_negative || std::accumulate(counts.begin(), counts.end(), std::size_t{0}) != all.size())
    in.fail(fmt::format("the numbers in {} do not sum to the {} of {}", in_quotes(group + "picks_of"),
                        all.size(), in_quotes(group + "picks")));
  std::vector<std::vector<std::int32_t>> picks;
  for (auto first = all.begin(); const std::int32_t count : counts) {
    picks.emplace_back(first, first + count);
    first += count;
  }
  return picks;
}

Mesh mesh_in(const FormReader& in) {
  Mesh mesh{.vertices = in.vectors("shape/points", 0), .faces = {}};
  const auto& corners = in.read<std::int32_t>("shape/faces", 0, 3);
  in.check_indices("shape/faces", corners, mesh.vertices.size());
  mesh.faces.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.faces.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return mesh;
}

PolygonCounts polygons_in(const FormReader& in) {
  if (!in.has("shape/polygons")) return {};
  const auto& counts = in.read<std::int64_t>("shape/polygons", 2);
  return {counts[0], counts[1]};
}

PointCloud cloud_in(const FormReader& in) {
  PointCloud cloud;
  cloud.points = in.vectors("shape/points", 0);
  if (in.has("shape/normals")) cloud.normals = in.vectors("shape/normals", cloud.points.size());
  if (in.has("shape/viewpoint")) {
    const auto& place = in.read<double>("shape/viewpoint", 3);
    cloud.viewpoint = Vec3(place[0], place[1], place[2]);
  }
  if (in.has("shape/left_out")) {
    cloud.dropped = in.read<std::int32_t>("shape/left_out", 0);
    in.check_indices("shape/left_out", cloud.dropped, cloud.size_in_file());
    if (std::ranges::adjacent_find(cloud.dropped, std::greater_equal()) != cloud.dropped.end())
      in.fail("data set 'shape/left_out': the numbers do not ascend");
  }
  return cloud;
}

TruthInForm truth_in(const FormReader& in, std::string_view view) {
  const std::string group = group_of(view);
  const std::size_t n = in.read<double>("shape/points", 0, 3).size() / 3;
  if (n == 0) in.fail("data set 'shape/points': there are no points");
  TruthInForm found{.view = std::string(view)};
  GroundTruth& truth = found.truth;
  if (in.has(group + "saliency")) {
    truth.saliency = in.values(group + "saliency", n);
    if (std::ranges::all_of(truth.saliency, [](double value) { return std::isnan(value); }))
      in.fail(fmt::format("data set {}: no point has a value", in_quotes(group + "saliency")));
  }
  if (const std::string viewers = group + "viewers"; in.has(viewers)) {
    const ScalarField& all = in.read<double>(viewers, 0, n);
    in.check_values(viewers, all);
    if (truth.saliency.empty())
      in.fail(fmt::format("has {} without {}", in_quotes(viewers), in_quotes(group + "saliency")));
    for (auto row = all.begin(); row != all.end(); row += static_cast<std::ptrdiff_t>(n))
      truth.viewers.emplace_back(row, row + static_cast<std::ptrdiff_t>(n));
  }
  if (in.has(group + "picks")) truth.picks = picks_in(in, group, n);
  if (truth.saliency.empty() && truth.picks.empty())
    in.fail(fmt::format("has neither {} nor {}: there is nothing to compare with",
                        in_quotes(group + "saliency"), in_quotes(group + "picks")));
  if (in.has(group + "faces"))
    found.face_values = in.values(group + "faces", in.read<std::int32_t>("shape/faces", 0, 3).size() / 3);
  return found;
}

// Views with ground truth, in the order of the arrays; "" for the shape as a whole.
std::vector<std::string_view> views_in(const Arrays& arrays) {
  std::vector<std::string_view> views;
  for (const Array& array : arrays) {
    std::string_view path = array.name;
    if (path.starts_with("truth/"))
      path = {};
    else if (path.starts_with(kViewGroups))
      path.remove_prefix(kViewGroups.size());
    else
      continue;
    const std::string_view view = path.substr(0, path.find('/'));
    if (std::ranges::find(views, view) == views.end()) views.push_back(view);
  }
  return views;
}

// nullopt unless one of our programs wrote the bytes, in a known version of the form.
std::optional<Hdf5Content> content_in_form(std::string_view image) {
  auto content = content_by_head(std::as_bytes(std::span(image)));
  if (!content) return {};
  const auto is = [&](std::string_view name, const AttributeValue& expected) {
    const AttributeValue* value = find_attribute(content->attributes, name);
    return value != nullptr && *value == expected;
  };
  const bool is_known = is("form_version", kFormVersion) || is("form_version", kVersionWithGaze);
  if (!is("form", std::string(kForm)) || !is_known) return {};
  return content;
}

}  // namespace

Arrays one_form_arrays(const ShapeInForm& shape) {
  Arrays arrays;
  add_shape(arrays, shape);
  for (const TruthInForm& truth : shape.truths) add_truth(arrays, truth);
  if (!shape.recording.empty()) add_recording(arrays, shape.recording);
  return arrays;
}

Bytes one_form_image(const ShapeInForm& shape) {
  Hdf5Content content{.arrays = one_form_arrays(shape), .attributes = {}};
  content.attributes = {{"form", std::string(kForm)},
                        {"form_version", shape.recording.empty() ? kFormVersion : kVersionWithGaze}};
  for (const auto& [key, text] : shape.about) content.attributes.emplace_back(key, text);
  return image_with_head(content);
}

namespace {

ShapeInForm shape_of(const Arrays& arrays, std::string_view name, std::optional<std::string_view> wanted) {
  const FormReader in{name, arrays};
  ShapeInForm shape{.polygons = polygons_in(in), .is_cloud = !in.has("shape/faces")};
  if (shape.is_cloud)
    shape.cloud = cloud_in(in);
  else
    shape.mesh = mesh_in(in);
  for (const std::string_view view : views_in(arrays))
    if (!wanted || view == *wanted) shape.truths.push_back(truth_in(in, view));
  shape.recording = recording_in(in);
  return shape;
}

}  // namespace

ShapeInForm shape_in_arrays(const Arrays& arrays, std::string_view name) {
  return shape_of(arrays, name, {});
}

std::optional<ShapeInForm> shape_in_form(std::string_view image, std::string_view name,
                                         std::optional<std::string_view> view) {
  const auto content = content_in_form(image);
  if (!content) return {};
  ShapeInForm shape = shape_of(content->arrays, name, view);
  for (const auto& [key, value] : content->attributes)
    if (const auto* text = std::get_if<std::string>(&value); text != nullptr && key != "form")
      shape.about.emplace_back(key, *text);
  return shape;
}

void require_form_of(std::string_view item, std::string_view image, std::string_view name) {
  const auto attributes = attributes_by_head(std::as_bytes(std::span(image)));
  const AttributeValue* named = attributes ? find_attribute(*attributes, "item") : nullptr;
  const auto* text = named == nullptr ? nullptr : std::get_if<std::string>(named);
  if (text != nullptr && *text != item)
    throw InputError(
        fmt::format("{}: is of the item {}, and index.csv says that it is of {}: put the right file there, "
                    "or import the set again",
                    name, in_quotes(*text), in_quotes(std::string(item))));
}

}  // namespace salbench
