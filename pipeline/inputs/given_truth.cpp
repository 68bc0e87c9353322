// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/given_truth.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/values_file.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/smoothing.h"
#include "stages/models/hs.h"

namespace salbench {
namespace {

// "ground truth, view 413"
std::string with_view(std::string_view name, const Item& item) {
  return fmt::format("{}{}{}", name, item.view.empty() ? "" : ", view ", item.view);
}

// Source of an item's contents, at the end of a message.
std::string_view listed_in(const Item& item) {
  return item.is_in_form() ? "index.csv (put the right file there, or import the set again)" : "its Item";
}

// Refuses a count that differs from the listed one; zero: participants are not told apart.
void require_people(const Item& item, std::string_view what, std::size_t found, std::size_t listed) {
  if (found > 0 && listed > 0 && found != listed)
    throw InputError(
        fmt::format("{}: has {} {}, and {} says {}", item.file, found, what, listed_in(item), listed));
}

GroundTruth read_truth(const Files& files, const Elements& points) {
  const Item& item = item_of(files.source);
  GroundTruth truth;
  auto file = files.data.begin();
  if (!item.saliency.empty()) truth.saliency = parse_values((file++)->text(), item.saliency, points);
  if (const std::string wrong = wrong_with_values(truth.saliency); !wrong.empty())
    throw FileError(item.saliency, wrong);
  for (const auto& path : item.picks) truth.picks.push_back(parse_picks((file++)->text(), path, points));
  if (std::ranges::all_of(truth.picks, [](const auto& picks) { return picks.empty(); })) truth.picks.clear();
  if (truth.saliency.empty() && truth.picks.empty())
    throw InputError(
        fmt::format("{}: nobody picked a point and there is no saliency file; remove the empty {} files",
                    item.picks.front(), std::filesystem::path(item.picks.front()).extension().string()));
  return truth;
}

// Message for a count that matches the mesh file's faces, or its triangles after polygons were split.
std::string told_of_faces(const Item& item, std::size_t count) try {
  PolygonCounts counts;
  const std::size_t triangles =
      parse_mesh(read_file(item.file, kMaxItemBytes), item.file, &counts).faces.size();
  const std::size_t in_file = faces_in_file(counts, triangles);
  if (count != in_file && count != triangles) return {};
  return fmt::format(", and {}: values of faces need a data set of their own (docs/data_sets.md)",
                     text_of_faces(in_file, triangles));
} catch (const InputError&) {
  return {};
}

const TruthInForm& truth_for(const Item& item, const ShapeInForm& form) {
  const auto found = std::ranges::find(form.truths, item.view, &TruthInForm::view);
  if (found == form.truths.end() && item.is_recorded())
    throw InputError(fmt::format(
        "{}: has a recording of gaze, and not, as other items, ground truth from elsewhere; write dataset: "
        "{{participants: recorded}}",
        item.file));
  if (found == form.truths.end())
    throw InputError(fmt::format("{}: has no {}, and {} says that it has", item.file,
                                 with_view("ground truth", item), listed_in(item)));
  require_people(item, "picks of participants", found->truth.picks.size(), item.participants);
  require_people(item, "values of viewers", found->truth.viewers.size(), item.viewers);
  return *found;
}

}  // namespace

std::vector<File> truth_files_of(const Item& item) {
  if (!item.problem.empty()) return {failing_file("ground truth", item.file, item.problem)};
  if (!item.has_truth()) return {};
  if (item.is_in_form()) return {{.name = with_view("ground truth in one form", item), .place = item.file}};
  if (item.read_by == ReadBy::front) return {nothing_to_read(with_view("ground truth", item), item.file)};
  std::vector<File> files;
  if (!item.saliency.empty()) files.push_back({.name = "saliency file", .place = item.saliency});
  for (std::size_t k = 0; k < item.picks.size(); ++k)
    files.push_back({.name = fmt::format("picks {}", k), .place = item.picks[k]});
  return files;
}

GroundTruth measured_truth(const Mesh& mesh, const Files& files) {
  const auto faces = [&](std::size_t count) { return told_of_faces(item_of(files.source), count); };
  return read_truth(files, {.n = mesh.vertices.size(), .others = faces});
}

GroundTruth measured_cloud_truth(const PointCloud& cloud, const Files& files) {
  GroundTruth truth = read_truth(files, {cloud.size_in_file(), "point cloud", "point", "points"});
  if (!truth.saliency.empty()) truth.saliency = values_left(cloud, truth.saliency);
  truth.picks = picks_left(cloud, std::move(truth.picks));
  return truth;
}

GroundTruth given_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files) {
  GroundTruth truth = truth_for(item_of(files.source), form).truth;
  if (truth.saliency.empty()) truth.saliency = smoothed_picks(mesh, truth.picks);
  return truth;
}

// Remaining faces keep the file's order, and the first of several equal faces is kept: each one matches the
// next equal face of the file.
GroundTruth given_face_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files) {
  const Item& item = item_of(files.source);
  const ScalarField& values = truth_for(item, form).face_values;
  if (values.empty())
    throw InputError(fmt::format(
        "{}: its ground truth has no values per face; write dataset: {{score_on: vertices}}", item.file));
  const Faces &in_file = form.mesh.faces, &left = mesh.faces;
  GroundTruth truth;
  for (std::size_t i = 0; i < in_file.size() && truth.saliency.size() < left.size(); ++i)
    if (in_file[i] == left[truth.saliency.size()]) truth.saliency.push_back(values[i]);
  CHECK_EQ(truth.saliency.size(), left.size());
  return truth;
}

std::size_t participants_of(const Item& item) {
  if (item.read_by == ReadBy::salbench) return item.picks.size();
  return std::max(item.participants, item.viewers);
}

bool has_participants(const Item& item) { return participants_of(item) >= kMinParticipants; }

}  // namespace salbench
