// Vec3 and Triangle are plain triples, so a vector of them is an n x 3 array as it lies in memory.
#include "io/value.h"

#include <cstring>

#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::int32_t));

constexpr const char* kLength = "mesh length unit";

template <class T, class Triple>
Array triples(const char* name, const std::vector<Triple>& rows, const char* unit, const char* description) {
  std::vector<T> flat(rows.size() * 3);
  if (!rows.empty()) std::memcpy(flat.data(), rows.data(), flat.size() * sizeof(T));
  return {name, {rows.size(), 3}, std::move(flat), unit, description};
}

template <class T>
Array column(const char* name, std::vector<T> values, const char* unit, const char* description) {
  const std::size_t n = values.size();
  return {name, {n}, std::move(values), unit, description};
}

template <class T>
Array scalar(const char* name, T value, const char* unit, const char* description) {
  return {name, {}, std::vector<T>{value}, unit, description};
}

template <class T>
const std::vector<T>& values_of(const Arrays& arrays, std::string_view name) {
  const Array* array = find_array(arrays, name);
  if (array == nullptr) throw InputError(fmt::format("the data set '{}' is missing", name));
  const auto* values = std::get_if<std::vector<T>>(&array->values);
  if (values == nullptr) throw InputError(fmt::format("the data set '{}' has another type", name));
  return *values;
}

template <class T>
T scalar_of(const Arrays& arrays, std::string_view name) {
  const auto& values = values_of<T>(arrays, name);
  if (values.size() != 1) throw InputError(fmt::format("the data set '{}' is not one number", name));
  return values[0];
}

template <class Triple, class T>
std::vector<Triple> triples_of(const Arrays& arrays, std::string_view name) {
  const auto& flat = values_of<T>(arrays, name);
  if (flat.size() % 3 != 0) throw InputError(fmt::format("the data set '{}' is not n x 3", name));
  std::vector<Triple> rows(flat.size() / 3);
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), flat.data(), flat.size() * sizeof(T));
  return rows;
}

// One layout: its name, and the two directions between struct and arrays.
template <class T>
struct Layout;

template <>
struct Layout<Mesh> {
  static constexpr std::string_view kind = "mesh";
  static Arrays write(const Mesh& mesh) {
    return {
        triples<double>("vertices", mesh.vertices, kLength, "positions, n x 3"),
        triples<std::int32_t>("faces", mesh.faces, "1", "0-based vertex indices, f x 3, counter-clockwise")};
  }
  static Mesh read(const Arrays& arrays) {
    return {triples_of<Vec3, double>(arrays, "vertices"),
            triples_of<Triangle, std::int32_t>(arrays, "faces")};
  }
};

template <>
struct Layout<Scan> {
  static constexpr std::string_view kind = "scan";
  static Arrays write(const Scan& scan) {
    return {
        triples<double>("points", scan.points, kLength, "first hits in the mesh's coordinates, row by row"),
        column<double>("camera", {scan.camera.x(), scan.camera.y(), scan.camera.z()}, kLength,
                       "centre of projection in the mesh's coordinates")};
  }
  static Scan read(const Arrays& arrays) {
    const auto cameras = triples_of<Vec3, double>(arrays, "camera");
    if (cameras.size() != 1) throw InputError("the data set 'camera' is not one position");
    return {triples_of<Vec3, double>(arrays, "points"), cameras[0]};
  }
};

template <>
struct Layout<Normals> {
  static constexpr std::string_view kind = "normals";
  static Arrays write(const Normals& normals) {
    return {triples<double>("normals", normals, "1", "unit normals, n x 3")};
  }
  static Normals read(const Arrays& arrays) { return triples_of<Vec3, double>(arrays, "normals"); }
};

template <>
struct Layout<Faces> {
  static constexpr std::string_view kind = "faces";
  static Arrays write(const Faces& faces) {
    return {triples<std::int32_t>("faces", faces, "1", "0-based point indices of a partial mesh, f x 3")};
  }
  static Faces read(const Arrays& arrays) { return triples_of<Triangle, std::int32_t>(arrays, "faces"); }
};

template <>
struct Layout<Descriptors> {
  static constexpr std::string_view kind = "descriptors";
  static Arrays write(const Descriptors& d) {
    return {{"fpfh", {d.size(), kFpfhBins}, d.values, "1", "FPFH, n x 33: 11 bins each of theta, alpha, phi"},
            scalar("radius", d.radius, kLength, "support radius; 0 where neighbours were counted"),
            scalar("neighbours", d.neighbours, "1",
                   "nearest points, itself included; 0 where a radius was used")};
  }
  static Descriptors read(const Arrays& arrays) {
    return {values_of<float>(arrays, "fpfh"), scalar_of<double>(arrays, "radius"),
            scalar_of<std::int32_t>(arrays, "neighbours")};
  }
};

template <>
struct Layout<ScalarField> {
  static constexpr std::string_view kind = "field";
  static Arrays write(const ScalarField& field) {
    return {column("saliency", field, "1", "one value per point, larger = more salient")};
  }
  static ScalarField read(const Arrays& arrays) { return values_of<double>(arrays, "saliency"); }
};

// Picks of all participants lie in one column; offsets[k] .. offsets[k + 1] are participant k's.
template <>
struct Layout<GroundTruth> {
  static constexpr std::string_view kind = "ground_truth";
  static Arrays write(const GroundTruth& truth) {
    std::vector<std::int32_t> picks;
    std::vector<std::int64_t> offsets = {0};
    for (const auto& participant : truth.picks) {
      picks.insert(picks.end(), participant.begin(), participant.end());
      offsets.push_back(static_cast<std::int64_t>(picks.size()));
    }
    return {
        column("saliency", truth.saliency, "1", "human saliency per point; empty where not known"),
        column("picks", std::move(picks), "1", "0-based point indices, participant after participant"),
        column("pick_offsets", std::move(offsets), "1", "where each participant's picks begin, and the end"),
        scalar("simulated", static_cast<std::int32_t>(truth.simulated), "1",
               "1: made by the program, says nothing about people")};
  }
  static GroundTruth read(const Arrays& arrays) {
    GroundTruth truth{
        values_of<double>(arrays, "saliency"), {}, scalar_of<std::int32_t>(arrays, "simulated") != 0};
    const auto& picks = values_of<std::int32_t>(arrays, "picks");
    const auto& offsets = values_of<std::int64_t>(arrays, "pick_offsets");
    for (std::size_t k = 0; k + 1 < offsets.size(); ++k) {
      if (offsets[k] < 0 || offsets[k] > offsets[k + 1] || offsets[k + 1] > std::ssize(picks))
        throw InputError("the data set 'pick_offsets' does not fit 'picks'");
      truth.picks.emplace_back(picks.begin() + offsets[k], picks.begin() + offsets[k + 1]);
    }
    return truth;
  }
};

template <>
struct Layout<Histogram> {
  static constexpr std::string_view kind = "histogram";
  static Arrays write(const Histogram& histogram) {
    return {column<double>("density", {histogram.begin(), histogram.end()}, "1",
                           "density over 100 bins of [0, 1]")};
  }
  static Histogram read(const Arrays& arrays) {
    const auto& values = values_of<double>(arrays, "density");
    Histogram histogram{};
    if (values.size() != histogram.size())
      throw InputError(
          fmt::format("data set 'density': expected {} bins, found {}", histogram.size(), values.size()));
    std::copy(values.begin(), values.end(), histogram.begin());
    return histogram;
  }
};

// The names of later metrics are in results.csv and the data dictionary: no layer below the table of metrics
// knows them.
constexpr const char* kScoreColumns =
    "one value per metric, in the order of results.csv: auc, auc_exact, nss, cc, lcc, then those added "
    "since; "
    "NaN where undefined";
constexpr const char* kCountColumns = "n_points, n_picks";

template <>
struct Layout<Scores> {
  static constexpr std::string_view kind = "scores";
  static Arrays write(const Scores& scores) {
    return {column("scores", scores.values, "1", kScoreColumns),
            column<std::int64_t>("counts", {scores.n_points, scores.n_picks}, "1", kCountColumns)};
  }
  static Scores read(const Arrays& arrays) {
    const auto& scores = values_of<double>(arrays, "scores");
    const auto& counts = values_of<std::int64_t>(arrays, "counts");
    if (counts.size() != 2)
      throw InputError(fmt::format("data set 'counts': expected 2 values, found {}", counts.size()));
    return {scores, counts[0], counts[1]};
  }
};

// One row per size of the groups: n = 1, 2, ...
template <>
struct Layout<HumanCurve> {
  static constexpr std::string_view kind = "human_curve";
  static Arrays write(const HumanCurve& curve) {
    std::vector<double> scores;
    std::vector<std::int64_t> counts;
    const std::size_t metrics = curve.empty() ? 0 : curve.front().values.size();
    for (const Scores& point : curve) {
      CHECK_EQ(point.values.size(), metrics);
      scores.insert(scores.end(), point.values.begin(), point.values.end());
      counts.insert(counts.end(), {point.n_points, point.n_picks});
    }
    return {{"scores", {curve.size(), metrics}, std::move(scores), "1", kScoreColumns},
            {"counts", {curve.size(), 2}, std::move(counts), "1", kCountColumns}};
  }
  static HumanCurve read(const Arrays& arrays) {
    const auto& scores = values_of<double>(arrays, "scores");
    const auto& counts = values_of<std::int64_t>(arrays, "counts");
    const std::size_t n = counts.size() / 2;
    const std::size_t metrics = n == 0 ? 0 : scores.size() / n;
    if (counts.size() != 2 * n || scores.size() != metrics * n)
      throw InputError(fmt::format("data sets 'scores' and 'counts': {} and {} values are not n rows of each",
                                   scores.size(), counts.size()));
    HumanCurve curve;
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = scores.begin() + static_cast<std::ptrdiff_t>(metrics * i);
      curve.push_back({{row, row + static_cast<std::ptrdiff_t>(metrics)}, counts[2 * i], counts[2 * i + 1]});
    }
    return curve;
  }
};

template <std::size_t I = 0>
Value read_kind(std::string_view kind, const Arrays& arrays) {
  if constexpr (I == std::variant_size_v<Value>) {
    throw InputError(fmt::format("the kind '{}' is not known to this version", kind));
  } else {
    using T = std::variant_alternative_t<I, Value>;
    return Layout<T>::kind == kind ? Value(Layout<T>::read(arrays)) : read_kind<I + 1>(kind, arrays);
  }
}

}  // namespace

Arrays arrays_from(const Value& value) {
  return std::visit([]<class T>(const T& v) { return Layout<T>::write(v); }, value);
}

std::string_view kind_of(const Value& value) {
  return std::visit([]<class T>(const T&) { return Layout<T>::kind; }, value);
}

Value value_from(std::string_view kind, const Arrays& arrays) { return read_kind(kind, arrays); }

}  // namespace salbench
