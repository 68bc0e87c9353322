// SPDX-License-Identifier: GPL-3.0-or-later
// Read back are points, faces and normals below shape/, and the values on the points below truth/, or below
// views/VIEW/ for views that are scored by themselves. The values of the source's files stand beside them,
// below as_read/, for people.
#include "io/one_form.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <fmt/format.h>

#include "io/hdf5_file.h"
#include "io/mesh_parts.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr const char* kForm = "salbench item";
constexpr std::int64_t kFormVersion = 1;
constexpr const char* kLength = "length unit of the source";
constexpr const char* kNumber = "number";

// --- writing ----------------------------------------------------------------------------------------------

void add_shape(Arrays& arrays, const ShapeInForm& shape) {
  const bool is_mesh = !shape.mesh.vertices.empty();
  arrays.push_back(triples("shape/points", is_mesh ? shape.mesh.vertices : shape.cloud.points, kLength,
                           "x, y and z of the points, or of the vertices of the mesh"));
  if (is_mesh)
    arrays.push_back(triples("shape/faces", shape.mesh.faces, kNumber,
                             "0-based points at the corners of the triangles, in the order of the source"));
  const PointCloud& cloud = shape.cloud;
  if (!cloud.normals.empty())
    arrays.push_back(triples("shape/normals", cloud.normals, "1", "unit normals of the points"));
  if (const auto& place = cloud.viewpoint)
    arrays.push_back(column("shape/viewpoint", std::vector<double>(place->begin(), place->end()), kLength,
                            "x, y and z from where the points were seen"));
  if (!cloud.dropped.empty())
    arrays.push_back(column("shape/left_out", cloud.dropped, kNumber,
                            "0-based numbers in the source of points that are left out here"));
}

void add_as_read(Arrays& arrays, const std::string& group, const ValuesAsRead& read) {
  arrays.push_back(column(group + "values", read.values, "1",
                          fmt::format("values per {} as {} has them; NaN: not seen", read.per, read.file)));
  if (!read.points.empty())
    arrays.push_back(triples(group + "points", read.points, kLength, "x, y and z that the values belong to"));
  if (!read.mask.empty())
    arrays.push_back(column(group + "mask", std::vector<std::uint8_t>(read.mask.begin(), read.mask.end()),
                            "1", "0: hidden, 1: seen"));
}

std::string group_of(std::string_view view) {
  return view.empty() ? "truth/" : fmt::format("views/{}/", view);
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
  for (std::size_t k = 0; k < truth.as_read.size(); ++k)
    add_as_read(arrays, fmt::format("{}as_read/{}/", group, k), truth.as_read[k]);
}

// --- reading ----------------------------------------------------------------------------------------------

// A file with the messages of what is wrong with it.
struct FormReader {
  std::string_view name;
  Hdf5Content content;

  FormReader(std::string_view image, std::string_view file_name)
      : name(file_name), content(foreign_hdf5_content(std::as_bytes(std::span(image)), file_name)) {
    const AttributeValue* form = find_attribute(content.attributes, "form");
    const auto* text = form == nullptr ? nullptr : std::get_if<std::string>(form);
    if (text == nullptr || *text != kForm)
      fail(fmt::format("has no attribute form = '{}': it is no file of `salbench convert`", kForm));
    const std::int64_t version = integer("form_version");
    if (version != kFormVersion)
      fail(fmt::format("is of version {} of the form, and this program reads {}: convert the set again",
                       version, kFormVersion));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name, what));
  }
  [[noreturn]] void fail(const Array& array, const std::string& what) const {
    fail(fmt::format("data set {}: {}", in_quotes(array.name), what));
  }

  std::int64_t integer(std::string_view attribute) const {
    const AttributeValue* value = find_attribute(content.attributes, attribute);
    if (value == nullptr) return 0;
    const auto* number = std::get_if<std::int64_t>(value);
    if (number == nullptr) fail(fmt::format("attribute '{}' is not a whole number", attribute));
    return *number;
  }

  bool has(std::string_view array) const { return find_array(content.arrays, array) != nullptr; }

  // The array of rows x columns numbers; rows: any, if it is 0.
  template <class T>
  const std::vector<T>& read(std::string_view array_name, std::size_t rows, std::size_t columns = 0) const {
    const Array* array = find_array(content.arrays, array_name);
    if (array == nullptr)
      fail(fmt::format("has no data set {}: convert the set again", in_quotes(std::string(array_name))));
    const auto* values = std::get_if<std::vector<T>>(&array->values);
    if (values == nullptr)
      fail(*array, std::is_same_v<T, double> ? "expected numbers of type float64"
                                             : "expected whole numbers of type int32");
    const std::size_t dimensions = columns == 0 ? 1 : 2;
    if (array->shape.size() != dimensions || (rows != 0 && array->shape[0] != rows) ||
        (columns != 0 && array->shape[1] != columns))
      fail(*array, fmt::format("its shape is ({}), expected ({}{})", fmt::join(array->shape, ", "),
                               rows == 0 ? "n" : std::to_string(rows),
                               columns == 0 ? "" : fmt::format(", {}", columns)));
    return *values;
  }

  std::vector<Vec3> vectors(std::string_view array_name, std::size_t rows) const {
    const std::vector<double>& values = read<double>(array_name, rows, 3);
    std::vector<Vec3> all(values.size() / 3);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
      if (const std::string_view wrong = wrong_with_point(all[i]); !wrong.empty())
        fail(*find_array(content.arrays, array_name), fmt::format("row {} (0-based): {}", i, wrong));
    }
    return all;
  }

  // Numbers of points below n.
  void check_indices(std::string_view array_name, std::span<const std::int32_t> indices,
                     std::size_t n) const {
    for (const std::int32_t i : indices)
      if (i < 0 || static_cast<std::size_t>(i) >= n)
        fail(fmt::format("data set {}: {} is out of range: there are {} points, numbered from 0",
                         in_quotes(std::string(array_name)), i, n));
  }

  ScalarField values(std::string_view array_name, std::size_t n) const {
    const ScalarField& values = read<double>(array_name, n);
    check_values(array_name, values);
    return values;
  }
  void check_values(std::string_view array_name, std::span<const double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isinf(values[i]))
        fail(fmt::format("data set {}: value {} (0-based) is {}, expected a finite number, or NaN",
                         in_quotes(std::string(array_name)), i, values[i]));
  }
};

std::vector<std::vector<std::int32_t>> picks_in(const FormReader& in, const std::string& group,
                                                std::size_t n) {
  const auto& all = in.read<std::int32_t>(group + "picks", 0);
  const auto& counts = in.read<std::int32_t>(group + "picks_of", 0);
  in.check_indices(group + "picks", all, n);
  const bool any_negative = std::ranges::any_of(counts, [](std::int32_t count) { return count < 0; });
  if (any_negative || std::accumulate(counts.begin(), counts.end(), std::size_t{0}) != all.size())
    in.fail(
        fmt::format("the numbers in '{0}picks_of' do not sum to the {1} of '{0}picks'", group, all.size()));
  std::vector<std::vector<std::int32_t>> picks;
  for (auto first = all.begin(); const std::int32_t count : counts) {
    picks.emplace_back(first, first + count);
    first += count;
  }
  return picks;
}

}  // namespace

Bytes one_form_image(const ShapeInForm& shape) {
  Hdf5Content content;
  content.attributes = {{"form", std::string(kForm)}, {"form_version", kFormVersion}};
  for (const auto& [key, text] : shape.about) content.attributes.emplace_back(key, text);
  if (shape.polygons.split > 0) {
    content.attributes.emplace_back("polygons_split", shape.polygons.split);
    content.attributes.emplace_back("polygons_concave", shape.polygons.concave);
  }
  add_shape(content.arrays, shape);
  for (const TruthInForm& truth : shape.truths) add_truth(content.arrays, truth);
  return hdf5_image(content);
}

Mesh mesh_in_form(std::string_view image, std::string_view name, PolygonCounts* counts) {
  const FormReader in(image, name);
  Mesh mesh{.vertices = in.vectors("shape/points", 0), .faces = {}};
  const auto& corners = in.read<std::int32_t>("shape/faces", 0, 3);
  in.check_indices("shape/faces", corners, mesh.vertices.size());
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.faces.push_back({corners[i], corners[i + 1], corners[i + 2]});
  if (counts != nullptr) *counts = {in.integer("polygons_split"), in.integer("polygons_concave")};
  return mesh;
}

PointCloud cloud_in_form(std::string_view image, std::string_view name) {
  const FormReader in(image, name);
  PointCloud cloud;
  cloud.points = in.vectors("shape/points", 0);
  if (in.has("shape/faces")) in.fail("has faces, and index.csv says that it is a point cloud");
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

GroundTruth truth_in_form(std::string_view image, std::string_view name, std::string_view view) {
  const FormReader in(image, name);
  const std::string group = group_of(view);
  const std::size_t n = in.read<double>("shape/points", 0, 3).size() / 3;
  if (n == 0) in.fail("data set 'shape/points': there are no points");
  GroundTruth truth;
  if (in.has(group + "saliency")) {
    truth.saliency = in.values(group + "saliency", n);
    if (std::ranges::all_of(truth.saliency, [](double value) { return std::isnan(value); }))
      in.fail(fmt::format("data set '{}saliency': no point has a value", group));
  }
  if (const std::string viewers = group + "viewers"; in.has(viewers)) {
    const ScalarField& all = in.read<double>(viewers, 0, n);
    in.check_values(viewers, all);
    for (auto row = all.begin(); row != all.end(); row += static_cast<std::ptrdiff_t>(n))
      truth.viewers.emplace_back(row, row + static_cast<std::ptrdiff_t>(n));
  }
  if (in.has(group + "picks")) truth.picks = picks_in(in, group, n);
  if (truth.saliency.empty() && truth.picks.empty())
    in.fail(fmt::format("has neither '{0}saliency' nor '{0}picks': there is nothing to compare with", group));
  return truth;
}

}  // namespace salbench
