// SPDX-License-Identifier: GPL-3.0-or-later
// Stages on shapes as arrays: normals, descriptors, scans, surfaces, ground truth, pictures.
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"
#include "stages/core/parallel.h"
#include "stages/descriptors/fpfh.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/smoothing.h"
#include "stages/ground_truth/carried.h"
#include "stages/models/simplified.h"
#include "stages/models/spectrum.h"
#include "stages/normals/normals.h"
#include "stages/picture/picture.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"

namespace salbench::python {
namespace {

int threads_from(py::handle threads) { return thread_count({threads, "threads"}); }

struct SurfaceView {
  View<Vec3> vertices;
  Faces faces;
};

SurfaceView surface_from(py::handle points_of, py::handle faces_of) {
  const auto vertices = points(required(points_of, "points"));
  return {vertices, faces(required(faces_of, "faces"), vertices.size())};
}

PointCloud cloud_from(py::handle points_of, py::handle viewpoint) {
  PointCloud cloud{.points = points(required(points_of, "points")).copy()};
  if (!viewpoint.is_none()) cloud.viewpoint = place({viewpoint, "viewpoint"});
  return cloud;
}

// --- normals and descriptors -------------------------------------------------------------------------------

py::array normals_of_mesh(const MeshNormalsOptions& options, py::handle points_of, py::handle faces_of,
                          py::handle threads) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  return moved(computed(threads_from(threads), [&] { return mesh_normals(mesh, options); }));
}

py::array normals_of_points(const ScanNormalsOptions& options, py::handle points_of, py::handle viewpoint,
                            py::handle threads) {
  const PointCloud cloud = cloud_from(points_of, viewpoint);
  if (cloud.points.empty()) throw py::value_error("points must have at least one");
  return moved(computed(threads_from(threads), [&] { return cloud_normals(cloud, options); }));
}

template <class Options>
py::array descriptors_of(const Options& options, py::handle points_of, py::handle normals_of,
                         py::handle threads) {
  const auto place_of = points(required(points_of, "points"));
  const auto normal_of = normals(required(normals_of, "normals"), place_of.size());
  return moved(computed(threads_from(threads),
                        [&] { return fpfh(place_of.values, normal_of.values, options).values; }),
               {-1, kFpfhBins});
}

// --- scans ------------------------------------------------------------------------------------------------

py::tuple scan_tuple(Scan scan) {
  return py::make_tuple(moved(std::move(scan.points)),
                        moved(std::vector<double>(scan.camera.begin(), scan.camera.end())));
}

py::tuple one_scan(const ScanOptions& options, py::handle points_of, py::handle faces_of, py::handle view) {
  const auto number = static_cast<int>(whole_number({view, "view"}, 0, kViews - 1));
  const Mesh mesh = mesh_from(points_of, faces_of);
  return scan_tuple(computed(1, [&] { return simulate_scan(mesh, number, options); }));
}

py::list all_scans(const ScanOptions& options, py::handle points_of, py::handle faces_of,
                   py::handle threads) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  std::array<Scan, kViews> scans;
  computed(threads_from(threads), [&] {
    const ScanScene scene(mesh);
    parallel_ranges(scans.size(), 1, [&](std::size_t view, std::size_t) {
      scans[view] = scene.scan(static_cast<int>(view), options);
    });
  });
  py::list result;
  for (Scan& scan : scans) result.append(scan_tuple(std::move(scan)));
  return result;
}

// --- surfaces ---------------------------------------------------------------------------------------------

py::array partial_mesh_of(const SurfaceOptions& options, py::handle points_of, py::handle normals_of) {
  const auto place_of = points(required(points_of, "points"));
  const Normals normal_of = normals(required(normals_of, "normals"), place_of.size()).copy();
  return moved(computed(1, [&] { return partial_mesh(place_of.values, normal_of, options); }));
}

py::tuple simplify(py::handle points_of, py::handle faces_of, py::handle target_faces) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  const std::uint64_t target =
      whole_number({target_faces, "target_faces"}, 0, std::numeric_limits<std::int32_t>::max());
  Mesh result = computed(1, [&] { return simplified(mesh, target); });
  return py::make_tuple(moved(std::move(result.vertices)), moved(std::move(result.faces)));
}

py::array vertex_areas(py::handle points_of, py::handle faces_of) {
  const auto [vertices, surface] = surface_from(points_of, faces_of);
  return moved(computed([&] { return barycentric_areas(vertices.values, surface); }));
}

py::tuple spectrum(py::handle points_of, py::handle faces_of, py::handle count) {
  const auto [vertices, surface] = surface_from(points_of, faces_of);
  const std::uint64_t k = whole_number({count, "k"}, 2, std::numeric_limits<std::int32_t>::max());
  const Eigenpairs pairs = computed(1, [&] { return spectrum_of(vertices.values, surface, k); });
  std::vector<double> vectors(static_cast<std::size_t>(pairs.vectors.size()));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      vectors.data(), pairs.vectors.rows(), pairs.vectors.cols()) = pairs.vectors;
  return py::make_tuple(moved(std::vector<double>(pairs.values.begin(), pairs.values.end())),
                        moved(std::move(vectors), {pairs.vectors.rows(), pairs.vectors.cols()}));
}

// --- ground truth -----------------------------------------------------------------------------------------

py::array smooth(const SmoothingOptions& options, py::handle points_of, py::handle faces_of,
                 py::handle picked) {
  const Mesh mesh = mesh_from(points_of, faces_of);
  const auto participants = picks(required(picked, "picks"), mesh.vertices.size());
  return moved(computed([&] { return smoothed_picks(mesh, participants, options); }));
}

// Transfer uses points only.
py::tuple carry(py::handle points_of, py::handle ground_truth, py::handle picked, py::handle scan_points) {
  const Mesh mesh{points(required(points_of, "points")).copy(), {}};
  const std::size_t n = mesh.vertices.size();
  GroundTruth truth;
  if (const Argument saliency{ground_truth, "ground_truth"}; saliency.given())
    truth.saliency = field(saliency, n).copy();
  truth.picks = picks({picked, "picks"}, n);
  const Scan scan{points(required(scan_points, "scan_points")).copy()};
  if (n == 0 && !scan.points.empty()) throw py::value_error("points must have at least one");
  GroundTruth carried = computed([&] { return scan_ground_truth(scan, mesh, truth); });
  py::list participants;
  for (std::vector<std::int32_t>& own : carried.picks) participants.append(moved(std::move(own)));
  return py::make_tuple(ground_truth.is_none() ? py::object(py::none()) : moved(std::move(carried.saliency)),
                        py::tuple(participants));
}

py::array of_faces(py::handle points_of, py::handle faces_of, py::handle values_of) {
  const auto [vertices, surface] = surface_from(points_of, faces_of);
  const auto values = field({values_of, "values"}, surface.size());
  return moved(computed([&] { return vertex_values_of_faces(vertices.values, surface, values.values); }));
}

py::array of_samples(py::handle points_of, py::handle samples_of, py::handle values_of, py::handle distance) {
  const auto vertices = points(required(points_of, "points"));
  const auto samples = points(required(samples_of, "samples"));
  if (samples.size() == 0) throw py::value_error("samples must have at least one point");
  const auto values = field({values_of, "values"}, samples.size());
  const double max_distance = real_number({distance, "max_distance"});
  if (!(max_distance >= 0)) throw py::value_error("max_distance must be a distance >= 0");
  return moved(computed([&] {
    return vertex_values_of_samples(vertices.values, samples.values, values.values, max_distance);
  }));
}

// --- pictures ---------------------------------------------------------------------------------------------

Picture rendered(py::handle points_of, py::handle faces_of, py::handle normals_of, py::handle viewpoint,
                 const RandomSource& random, int threads, const PictureOptions& options) {
  if (normals_of.is_none()) {
    if (faces_of.is_none()) throw py::value_error("normals must be given of points without faces");
    if (!viewpoint.is_none()) throw py::value_error("viewpoint must be None for a mesh");
    const Mesh mesh = mesh_from(points_of, faces_of);
    return computed(threads, [&] { return picture_of_mesh(mesh, options, random); });
  }
  const PointCloud cloud = cloud_from(points_of, viewpoint);
  const Normals normal_of = normals(required(normals_of, "normals"), cloud.points.size()).copy();
  const Faces given = faces({faces_of, "faces"}, cloud.points.size());
  return computed(threads, [&] {
    const Faces surface = faces_of.is_none() ? partial_mesh(cloud.points, normal_of) : given;
    return picture_of_cloud(cloud, normal_of, surface, options, random);
  });
}

// (primitive, weights, depth, shade, coverage, view_projection)
py::tuple picture(const PictureOptions& options, py::handle points_of, py::handle faces_of,
                  py::handle normals_of, py::handle viewpoint, py::handle seed, const std::string& item,
                  py::handle threads) {
  const RandomSource random{whole_number({seed, "seed"}, 0, UINT64_MAX), item};
  Picture picture =
      rendered(points_of, faces_of, normals_of, viewpoint, random, threads_from(threads), options);
  const py::ssize_t n = picture.size;
  const auto& matrix = picture.view_projection;
  return py::make_tuple(moved(std::move(picture.primitive), {n, n}),
                        moved(std::move(picture.weights), {n, n, 3}), moved(std::move(picture.depth), {n, n}),
                        moved(std::move(picture.shade), {n, n}), moved(std::move(picture.coverage), {n, n}),
                        moved(std::vector<double>(matrix.begin(), matrix.end()), {4, 4}));
}

}  // namespace

void bind_shapes(py::module_& module) {
  module.attr("views") = kViews;
  define(module, "mesh_normals", &normals_of_mesh, "estimate_normals");
  define(module, "cloud_normals", &normals_of_points, "estimate_normals");
  define(module, "fpfh", &descriptors_of<FpfhOptions>);
  define(module, "scan_fpfh", &descriptors_of<ScanFpfhOptions>, "fpfh");
  define(module, "simulate_scan", &one_scan);
  define(module, "simulate_scans", &all_scans);
  define(module, "partial_mesh", &partial_mesh_of);
  module.def("simplify", &simplify);
  module.def("vertex_areas", &vertex_areas);
  module.def("spectrum", &spectrum);
  define(module, "smooth_picks", &smooth);
  module.def("carry_ground_truth", &carry);
  module.def("vertex_values_of_faces", &of_faces);
  module.def("vertex_values_of_samples", &of_samples);
  define(module, "picture", &picture);
}

}  // namespace salbench::python
