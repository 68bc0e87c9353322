// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/value.h"

#include <algorithm>
#include <utility>

#include "io/hdf5/recording_form.h"
#include "io/hdf5/value_fields.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr const char* kMeshLength = "mesh length unit";
constexpr const char* kFileLength = "length unit of the file";

template <class V>
void visit(V& fields, Visited<V, Mesh>& mesh) {
  fields.column("vertices", mesh.vertices, kMeshLength, "positions, n x 3");
  fields.column("faces", mesh.faces, "1", "0-based vertex indices, f x 3, counter-clockwise");
}

template <class V>
void visit(V& fields, Visited<V, Scan>& scan) {
  fields.column("points", scan.points, kMeshLength, "first hits in the mesh's coordinates, row by row");
  fields.array("camera", scan.camera, {3}, kMeshLength, "centre of projection in the mesh's coordinates");
}

template <class V>
void visit(V& fields, Visited<V, Normals>& normals) {
  fields.column("normals", normals, "1", "unit normals, n x 3");
}

template <class V>
void visit(V& fields, Visited<V, Faces>& faces) {
  fields.column("faces", faces, "1", "0-based point indices of a partial mesh, f x 3");
}

template <class V>
void visit(V& fields, Visited<V, Descriptors>& d) {
  fields.table("fpfh", d.values, kFpfhBins, "1", "FPFH, n x 33: 11 bins each of theta, alpha, phi");
  fields.number("radius", d.radius, kMeshLength, "support radius; 0 where neighbours were counted");
  fields.number("neighbours", d.neighbours, "1",
                "nearest points, itself included; 0 where a radius was used");
}

template <class V>
void visit(V& fields, Visited<V, ScalarField>& field) {
  fields.column("saliency", field, "1", "one value per point, larger = more salient");
}

template <class V>
void visit(V& fields, Visited<V, Histogram>& histogram) {
  fields.array("density", histogram, {histogram.size()}, "1", "density over 100 bins of [0, 1]");
}

template <class V>
void visit(V& fields, Visited<V, CentreDensity>& density) {
  fields.array("marked", density.marked, {kCentreBins}, "1",
               "share of the ground truth by the distance from the centroid, R/100");
  fields.array("points", density.points, {kCentreBins}, "1", "share of the points by that distance");
  fields.number("shapes", density.shapes, "1", "shapes that these are sums over");
}

// --- ground truth: picks of all participants in one column ------------------------------------------------

template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& parts) {
  std::vector<T> all;
  for (const std::vector<T>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

// Participant k has offsets[k] .. offsets[k + 1].
std::vector<std::vector<std::int32_t>> picks_of(const std::vector<std::int32_t>& picks,
                                                const std::vector<std::int64_t>& offsets) {
  std::vector<std::vector<std::int32_t>> all;
  for (std::size_t k = 0; k + 1 < offsets.size(); ++k) {
    if (offsets[k] < 0 || offsets[k] > offsets[k + 1] || offsets[k + 1] > std::ssize(picks))
      throw InputError("the data set 'pick_offsets' does not fit 'picks'");
    all.emplace_back(picks.begin() + offsets[k], picks.begin() + offsets[k + 1]);
  }
  return all;
}

template <class V>
void visit(V& fields, Visited<V, GroundTruth>& truth) {
  std::vector<std::int32_t> picks = joined(truth.picks);
  std::vector<std::int64_t> offsets = {0};
  for (const auto& participant : truth.picks) offsets.push_back(offsets.back() + std::ssize(participant));
  auto simulated = static_cast<std::int32_t>(truth.simulated);
  fields.column("saliency", truth.saliency, "1", "human saliency per point; empty where not known");
  fields.column("picks", picks, "1", "0-based point indices, participant after participant");
  fields.column("pick_offsets", offsets, "1", "where each participant's picks begin, and the end");
  fields.number("simulated", simulated, "1", "1: made by the program, says nothing about people");
  std::vector<double> viewers = joined(truth.viewers);
  const std::size_t n = truth.saliency.size();
  if (fields.holds("viewers", !viewers.empty()))  // absent in files of older programs
    fields.table("viewers", viewers, n, "1",
                 "saliency per viewer and point; NaN where the viewer did not see the point");
  if constexpr (kReads<V>) {
    truth.picks = picks_of(picks, offsets);
    truth.simulated = simulated != 0;
    for (auto map = viewers.begin(); map != viewers.end(); map += static_cast<std::ptrdiff_t>(n))
      truth.viewers.emplace_back(map, map + static_cast<std::ptrdiff_t>(n));
  }
}

// --- scores -----------------------------------------------------------------------------------------------

// Later metrics are named in results.csv and the data dictionary: layers below the table of metrics do not
// know them.
constexpr const char* kScoreColumns =
    "one value per metric, in the order of results.csv: auc, auc_exact, nss, cc, lcc, then those added "
    "since; "
    "NaN where undefined";
constexpr const char* kCountColumns = "n_points, n_picks";

template <class V>
void visit(V& fields, Visited<V, Scores>& scores) {
  std::array<std::int64_t, 2> counts = {scores.n_points, scores.n_picks};
  fields.column("scores", scores.values, "1", kScoreColumns);
  fields.array("counts", counts, {2}, "1", kCountColumns);
  if constexpr (kReads<V>) scores.n_points = counts[0], scores.n_picks = counts[1];
}

// One row per group size: n = 1, 2, ...
template <class V>
void visit(V& fields, Visited<V, HumanCurve>& curve) {
  std::size_t metrics = curve.empty() ? 0 : curve.front().values.size();
  std::vector<double> scores;
  std::vector<std::int64_t> counts;
  for (const Scores& row : curve) {
    CHECK_EQ(row.values.size(), metrics);
    scores.insert(scores.end(), row.values.begin(), row.values.end());
    counts.insert(counts.end(), {row.n_points, row.n_picks});
  }
  fields.width("scores", metrics);
  fields.table("scores", scores, metrics, "1", kScoreColumns);
  fields.table("counts", counts, 2, "1", kCountColumns);
  if constexpr (kReads<V>) {
    if (counts.size() / 2 * metrics != scores.size())
      throw InputError("the data sets 'scores' and 'counts' have other numbers of rows");
    for (std::size_t i = 0; i < counts.size() / 2; ++i) {
      const auto row = scores.begin() + static_cast<std::ptrdiff_t>(metrics * i);
      curve.push_back({{row, row + static_cast<std::ptrdiff_t>(metrics)}, counts[2 * i], counts[2 * i + 1]});
    }
  }
}

// One row per shape, as a curve has one per group size.
template <class V>
void visit(V& fields, Visited<V, ScoreTable>& table) {
  visit(fields, table.rows);
}

// --- pictures and clouds ----------------------------------------------------------------------------------

template <class V>
void visit(V& fields, Visited<V, Picture>& picture) {
  auto side = static_cast<std::size_t>(picture.size);
  fields.width("primitive", side);
  constexpr bool kRepeats = true;
  fields.array("primitive", picture.primitive, {side, side}, "1",
               "face of the mesh or point of the scan that is seen; -1: nothing", kRepeats);
  fields.array("weights", picture.weights, {side, side, 3}, "1", "of the face's corners; of a point 1, 0, 0");
  fields.array("depth", picture.depth, {side, side}, kMeshLength,
               "along the viewing direction; infinity where nothing is seen", kRepeats);
  fields.array("shade", picture.shade, {side, side}, "1/255", "brightness of a white surface", kRepeats);
  fields.array("coverage", picture.coverage, {side, side}, "1/255", "the part that the shape fills",
               kRepeats);
  fields.array("view_projection", picture.view_projection, {4, 4}, "1",
               "world to clip space, for column vectors");
  if constexpr (kReads<V>) picture.size = static_cast<std::int32_t>(side);
}

void check_dropped(const PointCloud& cloud) {
  const auto in_file = static_cast<std::int64_t>(cloud.size_in_file());
  for (std::size_t i = 0; i < cloud.dropped.size(); ++i)
    if (cloud.dropped[i] < 0 || cloud.dropped[i] >= in_file ||
        (i > 0 && cloud.dropped[i] <= cloud.dropped[i - 1]))
      throw InputError("the data set 'dropped' does not ascend within the points of the file");
}

template <class V>
void visit(V& fields, Visited<V, PointCloud>& cloud) {
  std::vector<Vec3> viewpoint;
  if (cloud.viewpoint) viewpoint.push_back(*cloud.viewpoint);
  fields.column("points", cloud.points, kFileLength, "positions, n x 3, in the order of the file");
  fields.column("normals", cloud.normals, "1", "unit normals of the file, n x 3; empty if it has none");
  fields.column("viewpoint", viewpoint, kFileLength,
                "where the points were seen from, 1 x 3; empty if unknown");
  fields.column("dropped", cloud.dropped, "1",
                "0-based numbers in the file of the points without a position");
  if constexpr (kReads<V>) {
    if (viewpoint.size() > 1) throw InputError("the data set 'viewpoint' is not one position");
    if (!viewpoint.empty()) cloud.viewpoint = viewpoint[0];
    check_dropped(cloud);
  }
}

// --- gaze -------------------------------------------------------------------------------------------------

template <class V>
void visit(V& fields, Visited<V, GazePeople>& people) {
  std::vector<std::uint8_t> names = bytes_of_lines(people.names);
  fields.column("people", names, "1", "names of the people in UTF-8, each with a line feed behind it");
  fields.column("samples", people.samples, "1", "recorded of each person");
  fields.column("lost", people.lost, "1", "of these, without an eye or a place");
  fields.column("recorded", people.recorded, "ms", "from each person's first sample to the end of the last");
  fields.column("tracked", people.tracked, "ms", "of these, what samples with an eye and a place cover");
  if constexpr (kReads<V>) {
    people.names = lines_in_bytes(names);
    const std::size_t n = people.names.size();
    if (people.samples.size() != n || people.lost.size() != n || people.recorded.size() != n ||
        people.tracked.size() != n)
      throw InputError("the data sets of people are of other numbers of them than 'people'");
  }
}

void check_persons(const std::vector<std::int32_t>& person, const GazePeople& people) {
  const auto n = static_cast<std::int32_t>(people.names.size());
  if (!std::ranges::is_sorted(person) || (!person.empty() && (person.front() < 0 || person.back() >= n)))
    throw InputError("the data set 'person' does not ascend within the people");
}

template <class V>
void visit(V& fields, Visited<V, GazeFixations>& fixations) {
  visit(fields, fixations.people);
  fields.column("person", fixations.person, "1", "0-based number of who looked, ascending");
  fields.column("start", fixations.start, "ms", "when each fixation begins");
  fields.column("duration", fixations.duration, "ms", "how long it lasts");
  fields.column("origins", fixations.origins, kMeshLength, "where the eye was; empty where not known");
  fields.column("directions", fixations.directions, "1",
                "unit vectors of gaze; empty where places are known");
  fields.column("points", fixations.points, kMeshLength,
                "places looked at; empty where directions are known");
  if constexpr (kReads<V>) {
    check_persons(fixations.person, fixations.people);
    const std::size_t k = fixations.person.size();
    const auto fits = [k](std::size_t size) { return size == k || size == 0; };
    if (fixations.start.size() != k || fixations.duration.size() != k || !fits(fixations.origins.size()) ||
        fixations.directions.size() + fixations.points.size() != k || !fits(fixations.points.size()))
      throw InputError("the columns of fixations have other numbers of rows");
  }
}

template <class V>
void visit(V& fields, Visited<V, GazeHits>& hits) {
  visit(fields, hits.people);
  fields.column("person", hits.person, "1", "0-based number of who looked, ascending");
  const Extents rows = {hits.person.size()};
  fields.array("start", hits.start, rows, "ms", "when each fixation begins");
  fields.array("duration", hits.duration, rows, "ms", "how long it lasts");
  fields.array("face", hits.face, rows, "1", "0-based face of the mesh that it is on; -1: it missed");
  fields.column("weights", hits.weights, "1", "barycentric, of the face's corners");
  fields.array("depth", hits.depth, rows, kMeshLength, "distance from the eye; NaN where not known");
  fields.array("snapped", hits.snapped, rows, "1", "1: the nearest direction that meets the mesh was taken");
  fields.column("eyes", hits.eyes, kMeshLength, "where the eye was; empty where not known");
  if constexpr (kReads<V>) {
    check_persons(hits.person, hits.people);
    const std::size_t k = hits.person.size();
    if (hits.weights.size() != k || (hits.eyes.size() != k && !hits.eyes.empty()))
      throw InputError("the data sets 'weights' and 'eyes' have other numbers of rows than 'person'");
  }
}

template <class V>
void visit(V& fields, Visited<V, VisibleShares>& visible) {
  fields.width("shares", visible.n);
  fields.table("shares", visible.shares, visible.n, "1",
               "share of each person's time of fixations in which the vertex could be seen");
}

}  // namespace

template <Storable T>
Arrays ArrayForm<T>::arrays(const T& value) {
  if constexpr (std::is_same_v<T, ShapeInForm>) {
    return one_form_arrays(value);
  } else {
    FieldsOut fields;
    visit(fields, value);
    return std::move(fields.arrays);
  }
}
template <Storable T>
T ArrayForm<T>::read(const Arrays& arrays) {
  if constexpr (std::is_same_v<T, ShapeInForm>) {
    return shape_in_arrays(arrays, "the HDF5 form");
  } else {
    T value{};
    FieldsIn fields(arrays);
    visit(fields, value);
    return value;
  }
}

template <>
const std::string_view ArrayForm<Mesh>::kind = "mesh";
template <>
const std::string_view ArrayForm<Scan>::kind = "scan";
template <>
const std::string_view ArrayForm<Normals>::kind = "normals";
template <>
const std::string_view ArrayForm<Faces>::kind = "faces";
template <>
const std::string_view ArrayForm<Descriptors>::kind = "descriptors";
template <>
const std::string_view ArrayForm<ScalarField>::kind = "field";
template <>
const std::string_view ArrayForm<GroundTruth>::kind = "ground_truth";
template <>
const std::string_view ArrayForm<Histogram>::kind = "histogram";
template <>
const std::string_view ArrayForm<Scores>::kind = "scores";
template <>
const std::string_view ArrayForm<HumanCurve>::kind = "human_curve";
template <>
const std::string_view ArrayForm<Picture>::kind = "picture";
template <>
const std::string_view ArrayForm<PointCloud>::kind = "point_cloud";
template <>
const std::string_view ArrayForm<ScoreTable>::kind = "score_table";
template <>
const std::string_view ArrayForm<CentreDensity>::kind = "centre_density";
template <>
const std::string_view ArrayForm<ShapeInForm>::kind = "shape_in_form";
template <>
const std::string_view ArrayForm<VisibleShares>::kind = "visible_shares";
template <>
const std::string_view ArrayForm<GazeHits>::kind = "gaze_hits";
template <>
const std::string_view ArrayForm<GazeFixations>::kind = "fixations";

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
template struct ArrayForm<VisibleShares>;
template struct ArrayForm<GazeHits>;
template struct ArrayForm<GazeFixations>;

}  // namespace salbench
