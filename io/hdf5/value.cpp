// SPDX-License-Identifier: GPL-3.0-or-later
// Vec3 and Triangle are plain triples, so a vector of them is an n x 3 array as it lies in memory.
#include "io/hdf5/value.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "io/hdf5/value_arrays.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::int32_t));

constexpr const char* kMeshLength = "mesh length unit";

template <class Triple>
std::vector<Triple> triples_of(const Arrays& arrays, std::string_view name) {
  const auto& flat = values_of<typename Triple::value_type>(arrays, name);
  if (flat.size() % 3 != 0) throw InputError(fmt::format("the data set '{}' is not n x 3", name));
  std::vector<Triple> rows(flat.size() / 3);
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), flat.data(), rows.size() * sizeof(Triple));
  return rows;
}

template <class T>
struct Is {};

// --- the two directions of each kind ----------------------------------------------------------------------

Arrays arrays_of(const Mesh& mesh) {
  return {triples("vertices", mesh.vertices, kMeshLength, "positions, n x 3"),
          triples("faces", mesh.faces, "1", "0-based vertex indices, f x 3, counter-clockwise")};
}
Mesh from(const Arrays& arrays, Is<Mesh>) {
  return Mesh{triples_of<Vec3>(arrays, "vertices"), triples_of<Triangle>(arrays, "faces")};
}

Arrays arrays_of(const Scan& scan) {
  return {triples("points", scan.points, kMeshLength, "first hits in the mesh's coordinates, row by row"),
          column<double>("camera", {scan.camera.x(), scan.camera.y(), scan.camera.z()}, kMeshLength,
                         "centre of projection in the mesh's coordinates")};
}
Scan from(const Arrays& arrays, Is<Scan>) {
  const auto cameras = triples_of<Vec3>(arrays, "camera");
  if (cameras.size() != 1) throw InputError("the data set 'camera' is not one position");
  return Scan{triples_of<Vec3>(arrays, "points"), cameras[0]};
}

Arrays arrays_of(const Normals& normals) { return {triples("normals", normals, "1", "unit normals, n x 3")}; }
Normals from(const Arrays& arrays, Is<Normals>) { return triples_of<Vec3>(arrays, "normals"); }

Arrays arrays_of(const Faces& faces) {
  return {triples("faces", faces, "1", "0-based point indices of a partial mesh, f x 3")};
}
Faces from(const Arrays& arrays, Is<Faces>) { return triples_of<Triangle>(arrays, "faces"); }

Arrays arrays_of(const Descriptors& d) {
  return {
      {"fpfh", {d.size(), kFpfhBins}, d.values, "1", "FPFH, n x 33: 11 bins each of theta, alpha, phi"},
      scalar("radius", d.radius, kMeshLength, "support radius; 0 where neighbours were counted"),
      scalar("neighbours", d.neighbours, "1", "nearest points, itself included; 0 where a radius was used")};
}
Descriptors from(const Arrays& arrays, Is<Descriptors>) {
  return Descriptors{values_of<float>(arrays, "fpfh"), scalar_of<double>(arrays, "radius"),
                     scalar_of<std::int32_t>(arrays, "neighbours")};
}

Arrays arrays_of(const ScalarField& field) {
  return {column("saliency", field, "1", "one value per point, larger = more salient")};
}
ScalarField from(const Arrays& arrays, Is<ScalarField>) { return values_of<double>(arrays, "saliency"); }

// Picks of all participants lie in one column; offsets[k] .. offsets[k + 1] are participant k's.
Arrays arrays_of(const GroundTruth& truth) {
  std::vector<std::int32_t> picks;
  std::vector<std::int64_t> offsets = {0};
  for (const auto& participant : truth.picks) {
    picks.insert(picks.end(), participant.begin(), participant.end());
    offsets.push_back(static_cast<std::int64_t>(picks.size()));
  }
  Arrays arrays = {
      column("saliency", truth.saliency, "1", "human saliency per point; empty where not known"),
      column("picks", std::move(picks), "1", "0-based point indices, participant after participant"),
      column("pick_offsets", std::move(offsets), "1", "where each participant's picks begin, and the end"),
      scalar("simulated", static_cast<std::int32_t>(truth.simulated), "1",
             "1: made by the program, says nothing about people")};
  if (truth.viewers.empty()) return arrays;  // as older programs wrote it
  std::vector<double> viewers;
  for (const ScalarField& map : truth.viewers) viewers.insert(viewers.end(), map.begin(), map.end());
  arrays.push_back({"viewers",
                    {truth.viewers.size(), truth.viewers[0].size()},
                    std::move(viewers),
                    "1",
                    "saliency per viewer and point; NaN where the viewer did not see the point"});
  return arrays;
}
GroundTruth from(const Arrays& arrays, Is<GroundTruth>) {
  GroundTruth truth{
      values_of<double>(arrays, "saliency"), {}, scalar_of<std::int32_t>(arrays, "simulated") != 0};
  const auto& picks = values_of<std::int32_t>(arrays, "picks");
  const auto& offsets = values_of<std::int64_t>(arrays, "pick_offsets");
  for (std::size_t k = 0; k + 1 < offsets.size(); ++k) {
    if (offsets[k] < 0 || offsets[k] > offsets[k + 1] || offsets[k + 1] > std::ssize(picks))
      throw InputError("the data set 'pick_offsets' does not fit 'picks'");
    truth.picks.emplace_back(picks.begin() + offsets[k], picks.begin() + offsets[k + 1]);
  }
  if (find_array(arrays, "viewers") == nullptr) return truth;
  const auto& viewers = values_of<double>(arrays, "viewers");
  const std::size_t n = truth.saliency.size();
  if (n == 0 || viewers.size() % n != 0) throw InputError("the data set 'viewers' does not fit 'saliency'");
  for (auto map = viewers.begin(); map != viewers.end(); map += static_cast<std::ptrdiff_t>(n))
    truth.viewers.emplace_back(map, map + static_cast<std::ptrdiff_t>(n));
  return truth;
}

Arrays arrays_of(const Histogram& histogram) {
  return {column<double>("density", {histogram.begin(), histogram.end()}, "1",
                         "density over 100 bins of [0, 1]")};
}
Histogram from(const Arrays& arrays, Is<Histogram>) {
  const auto& values = values_of<double>(arrays, "density");
  Histogram histogram{};
  if (values.size() != histogram.size())
    throw InputError(
        fmt::format("data set 'density': expected {} bins, found {}", histogram.size(), values.size()));
  std::copy(values.begin(), values.end(), histogram.begin());
  return histogram;
}

// The names of later metrics are in results.csv and the data dictionary: no layer below the table of metrics
// knows them.
constexpr const char* kScoreColumns =
    "one value per metric, in the order of results.csv: auc, auc_exact, nss, cc, lcc, then those added "
    "since; "
    "NaN where undefined";

// One row per group size: n = 1, 2, ...
Arrays arrays_of(const HumanCurve& curve) {
  std::vector<double> scores;
  std::vector<std::int64_t> counts;
  const std::size_t metrics = curve.empty() ? 0 : curve.front().values.size();
  for (const Scores& s : curve) {
    CHECK_EQ(s.values.size(), metrics);
    scores.insert(scores.end(), s.values.begin(), s.values.end());
    counts.insert(counts.end(), {s.n_points, s.n_picks});
  }
  return {{"scores", {curve.size(), metrics}, scores, "1", kScoreColumns},
          {"counts", {curve.size(), 2}, counts, "1", "n_points, n_picks"}};
}
HumanCurve curve_of(const Arrays& arrays) {
  const auto& scores = values_of<double>(arrays, "scores");
  const auto& counts = values_of<std::int64_t>(arrays, "counts");
  HumanCurve curve(counts.size() / 2);
  const std::size_t metrics = curve.empty() ? 0 : scores.size() / curve.size();
  if (scores.size() != metrics * curve.size() || counts.size() != 2 * curve.size())
    throw InputError(fmt::format("data sets 'scores' and 'counts': {} and {} values are not n rows of each",
                                 scores.size(), counts.size()));
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto row = scores.begin() + static_cast<std::ptrdiff_t>(metrics * i);
    curve[i] = {{row, row + static_cast<std::ptrdiff_t>(metrics)}, counts[2 * i], counts[2 * i + 1]};
  }
  return curve;
}
HumanCurve from(const Arrays& arrays, Is<HumanCurve>) { return curve_of(arrays); }

// As a curve has one row per group size, the table has one per shape.
Arrays arrays_of(const ScoreTable& table) { return arrays_of(table.rows); }
ScoreTable from(const Arrays& arrays, Is<ScoreTable>) { return ScoreTable{curve_of(arrays)}; }

// A curve of one point, without the dimension of the group size.
Arrays arrays_of(const Scores& scores) {
  Arrays arrays = arrays_of(HumanCurve{scores});
  for (Array& array : arrays) array.shape.erase(array.shape.begin());
  return arrays;
}
Scores from(const Arrays& arrays, Is<Scores>) {
  const HumanCurve curve = curve_of(arrays);
  if (curve.size() != 1) throw InputError("the data sets 'scores' and 'counts' have other sizes");
  return curve[0];
}

template <class T>
Array pixels(const char* name, const Picture& picture, const std::vector<T>& values, const char* unit,
             const char* description) {
  const auto side = static_cast<std::size_t>(picture.size);
  return {name, {side, side}, values, unit, description, true};
}

Arrays arrays_of(const Picture& picture) {
  const auto side = static_cast<std::size_t>(picture.size);
  return {pixels("primitive", picture, picture.primitive, "1",
                 "face of the mesh or point of the scan that is seen; -1: nothing"),
          {"weights", {side, side, 3}, picture.weights, "1", "of the face's corners; of a point 1, 0, 0"},
          pixels("depth", picture, picture.depth, kMeshLength,
                 "along the viewing direction; infinity where nothing is seen"),
          pixels("shade", picture, picture.shade, "1/255", "brightness of a white surface"),
          pixels("coverage", picture, picture.coverage, "1/255", "the part that the shape fills"),
          {"view_projection",
           {4, 4},
           std::vector<double>(picture.view_projection.begin(), picture.view_projection.end()),
           "1",
           "world to clip space, for column vectors"}};
}

template <class T>
const std::vector<T>& pixels_of(const Arrays& arrays, std::string_view name, std::size_t count) {
  const auto& values = values_of<T>(arrays, name);
  if (values.size() != count)
    throw InputError(
        fmt::format("data set '{}': {} values, but the picture needs {}", name, values.size(), count));
  return values;
}

Picture from(const Arrays& arrays, Is<Picture>) {
  const Array* primitive = find_array(arrays, "primitive");
  if (primitive == nullptr || primitive->shape.size() != 2 || primitive->shape[0] != primitive->shape[1])
    throw InputError("the data set 'primitive' is not a square of pixels");
  Picture picture;
  picture.size = static_cast<std::int32_t>(primitive->shape[0]);
  const std::size_t n = picture.pixels();
  picture.primitive = pixels_of<std::int32_t>(arrays, "primitive", n);
  picture.weights = pixels_of<float>(arrays, "weights", 3 * n);
  picture.depth = pixels_of<float>(arrays, "depth", n);
  picture.shade = pixels_of<std::uint8_t>(arrays, "shade", n);
  picture.coverage = pixels_of<std::uint8_t>(arrays, "coverage", n);
  const auto& matrix = pixels_of<double>(arrays, "view_projection", picture.view_projection.size());
  std::copy(matrix.begin(), matrix.end(), picture.view_projection.begin());
  return picture;
}

Arrays arrays_of(const PointCloud& cloud) {
  const std::vector<Vec3> viewpoint =
      cloud.viewpoint ? std::vector<Vec3>{*cloud.viewpoint} : std::vector<Vec3>{};
  return {
      triples("points", cloud.points, "length unit of the file",
              "positions, n x 3, in the order of the file"),
      triples("normals", cloud.normals, "1", "unit normals of the file, n x 3; empty if it has none"),
      triples("viewpoint", viewpoint, "length unit of the file",
              "where the points were seen from, 1 x 3; empty if unknown"),
      column("dropped", cloud.dropped, "1", "0-based numbers in the file of the points without a position")};
}
PointCloud from(const Arrays& arrays, Is<PointCloud>) {
  PointCloud cloud{.points = triples_of<Vec3>(arrays, "points"),
                   .normals = triples_of<Vec3>(arrays, "normals"),
                   .dropped = values_of<std::int32_t>(arrays, "dropped")};
  const auto viewpoint = triples_of<Vec3>(arrays, "viewpoint");
  if (viewpoint.size() > 1) throw InputError("the data set 'viewpoint' is not one position");
  if (!viewpoint.empty()) cloud.viewpoint = viewpoint[0];
  const auto in_file = static_cast<std::int64_t>(cloud.size_in_file());
  for (std::size_t i = 0; i < cloud.dropped.size(); ++i)
    if (cloud.dropped[i] < 0 || cloud.dropped[i] >= in_file ||
        (i > 0 && cloud.dropped[i] <= cloud.dropped[i - 1]))
      throw InputError("the data set 'dropped' does not ascend within the points of the file");
  return cloud;
}

Arrays arrays_of(const CentreDensity& density) {
  const auto bins = [](const char* name, const auto& values, const char* description) {
    return column<double>(name, {values.begin(), values.end()}, "1", description);
  };
  return {
      bins("marked", density.marked, "share of the ground truth by the distance from the centroid, R/100"),
      bins("points", density.points, "share of the points by that distance"),
      scalar("shapes", density.shapes, "1", "shapes that these are sums over")};
}
CentreDensity from(const Arrays& arrays, Is<CentreDensity>) {
  CentreDensity density;
  for (auto [name, bins] : {std::pair("marked", &density.marked), {"points", &density.points}}) {
    const auto& values = values_of<double>(arrays, name);
    if (values.size() != bins->size())
      throw InputError(
          fmt::format("data set '{}': expected {} bins, found {}", name, bins->size(), values.size()));
    std::copy(values.begin(), values.end(), bins->begin());
  }
  density.shapes = scalar_of<std::int64_t>(arrays, "shapes");
  return density;
}

Arrays arrays_of(const ShapeInForm& shape) { return one_form_arrays(shape); }
ShapeInForm from(const Arrays& arrays, Is<ShapeInForm>) { return shape_in_arrays(arrays, "the one form"); }

// --- the name of each kind --------------------------------------------------------------------------------

constexpr std::string_view kind_of(Is<Mesh>) { return "mesh"; }
constexpr std::string_view kind_of(Is<Scan>) { return "scan"; }
constexpr std::string_view kind_of(Is<Normals>) { return "normals"; }
constexpr std::string_view kind_of(Is<Faces>) { return "faces"; }
constexpr std::string_view kind_of(Is<Descriptors>) { return "descriptors"; }
constexpr std::string_view kind_of(Is<ScalarField>) { return "field"; }
constexpr std::string_view kind_of(Is<GroundTruth>) { return "ground_truth"; }
constexpr std::string_view kind_of(Is<Histogram>) { return "histogram"; }
constexpr std::string_view kind_of(Is<Scores>) { return "scores"; }
constexpr std::string_view kind_of(Is<HumanCurve>) { return "human_curve"; }
constexpr std::string_view kind_of(Is<Picture>) { return "picture"; }
constexpr std::string_view kind_of(Is<PointCloud>) { return "point_cloud"; }
constexpr std::string_view kind_of(Is<ScoreTable>) { return "score_table"; }
constexpr std::string_view kind_of(Is<CentreDensity>) { return "centre_density"; }
constexpr std::string_view kind_of(Is<ShapeInForm>) { return "shape_in_form"; }

}  // namespace

template <Storable T>
const std::string_view ArrayForm<T>::kind = kind_of(Is<T>{});
template <Storable T>
Arrays ArrayForm<T>::arrays(const T& value) {
  return arrays_of(value);
}
template <Storable T>
T ArrayForm<T>::read(const Arrays& arrays) {
  return from(arrays, Is<T>{});
}

template struct ArrayForm<Mesh>;
template struct ArrayForm<Scan>;
template struct ArrayForm<Normals>;
template struct ArrayForm<Faces>;
template struct ArrayForm<Descriptors>;
template struct ArrayForm<ScalarField>;
template struct ArrayForm<GroundTruth>;
template struct ArrayForm<Histogram>;
template struct ArrayForm<Scores>;
template struct ArrayForm<HumanCurve>;
template struct ArrayForm<Picture>;
template struct ArrayForm<PointCloud>;
template struct ArrayForm<ScoreTable>;
template struct ArrayForm<CentreDensity>;
template struct ArrayForm<ShapeInForm>;

}  // namespace salbench
