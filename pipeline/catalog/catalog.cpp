// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/catalog.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "pipeline/catalog/given_maps.h"
#include "pipeline/catalog/given_truth.h"
#include "pipeline/catalog/human.h"
#include "pipeline/catalog/loading.h"
#include "stages/core/centre.h"
#include "stages/core/field.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/point_cloud.h"
#include "stages/core/seen.h"
#include "stages/ground_truth/scan_truth.h"
#include "stages/matching/matching.h"
#include "stages/picture/picture.h"

namespace salbench {
namespace {

// --- functions of rows that are more than one stage's ------------------------------------------------------

GroundTruth simulate_ground_truth(const Mesh& mesh, const SimulationOptions& options,
                                  const RandomSource& random) {
  return simulated_ground_truth(mesh, options, random.seed, random.item);
}

GroundTruth made_up_cloud_ground_truth(const PointCloud& cloud, Surface surface,
                                       const SimulationOptions& options, const RandomSource& random) {
  return simulate_ground_truth(mesh_of(cloud, surface), options, random);
}

Scan scan_of(const ScanScene& scene, const View& view, const ScanOptions& options) {
  return scene.scan(view.index, options);
}

// Saliency where it is known.
ScalarField seen_values(const GroundTruth& truth) {
  const auto seen = seen_points(truth.saliency);
  return seen ? values_at(truth.saliency, *seen) : truth.saliency;
}
const ScalarField& seen_values(const ScalarField& map) { return map; }

// Serial and in the order of the items: sums of doubles depend on their order.
template <class T>
Histogram mean_over(const Members<T>& members) {
  std::vector<Histogram> histograms;
  for (std::size_t i = 0; i < members.size; ++i) {
    const ValuePtr member = members.value(i);
    const auto& values = seen_values(std::get<T>(*member));
    // A scan may show nothing known. An infinite value fails stages of its own item, and nothing here.
    if (!values.empty() && std::ranges::none_of(values, [](double value) { return std::isinf(value); }))
      histograms.push_back(normalised_histogram(values));
  }
  return mean_histogram(histograms);
}

ScoreTable score_table(const Members<Scores>& members) {
  ScoreTable table;
  for (std::size_t i = 0; i < members.size; ++i) table.rows.push_back(std::get<Scores>(*members.value(i)));
  return table;
}

// --- groups of rows ----------------------------------------------------------------------------------------

// A map from outside in place of a computed one. The points are read for their number alone.
RowOf<ScalarField> add_given_map(Catalog& catalog, const ShapeRows& shape, const Model& model, RowHead head) {
  if (shape.shapes == Shapes::clouds)
    return catalog.add(
        shape.shapes, std::move(head),
        [maps = model.given](const PointCloud& cloud, const FilesOf<Source::map_file>& file) {
          return maps->checked(file.data[0], file.name, cloud.points.size(), &cloud);
        },
        RowOf<PointCloud>(shape.points.row), kFiles<Source::map_file>);
  return catalog.add(
      shape.shapes, std::move(head),
      [maps = model.given](Points points, const FilesOf<Source::map_file>& file) {
        return maps->checked(file.data[0], file.name, points.size());
      },
      shape.points, kFiles<Source::map_file>);
}

ScalarField centre_bias_if(bool needed, Points points) {
  return needed ? distances_from_centroid(points) : ScalarField{};
}

// The row where it is needed.
template <class T>
std::optional<RowOf<T>> only_if(bool needed, const RowOf<T>& row) {
  return needed ? std::optional(row) : std::nullopt;
}

// Reads the map in the readings that the metrics ask for, and the surface where they weigh by area: other
// scores are found whatever these are.
void add_scores(Catalog& catalog, const ShapeRows& shape, const Config& config, const Model& model,
                RowOf<FieldView> map, RowOf<FieldView> matched_map) {
  const std::string name = "scores." + model.name;
  const auto metrics = std::make_shared<const MetricsByMatching>(config.metrics);
  const bool by_area = any_by_area(metrics->all()), of_positions = any_of_positions(metrics->all());
  catalog.add(
      shape.shapes, {name, scores_version(metrics->all())},
      [name, metrics, of_positions](FieldView matched_values, FieldView values, const GroundTruth& truth,
                                    Points points, Surface surface, const MetricsOptions& options,
                                    const RandomSource& random) {
        Draws draws(random.rng(name));
        const Measures measures(std::max(matched_values.size(), values.size()),
                                barycentric_areas(points, surface), centre_bias_if(of_positions, points));
        return metrics->score([&](std::span<const Metric> of_part, Matching read) {
          return read == Matching::histogram
                     ? score(of_part, matched_values, truth, options, draws, measures)
                     : score(of_part, min_max_normalised(values), truth, options, draws, measures);
        });
      },
      only_if(metrics->any(Matching::histogram), matched_map), only_if(metrics->any(Matching::none), map),
      shape.ground_truth, only_if(by_area || of_positions, shape.points), only_if(by_area, shape.surface),
      section("metrics", config.metrics), kRandom);
}

// Scores of a constant map by the metrics that score it otherwise on each shape: what models are compared
// with in remarks.
void add_constant_scores(Catalog& catalog, const ShapeRows& shape, const Config& config) {
  MetricsOptions varying = config.metrics;
  varying.names.clear();
  varying.matching.clear();  // a constant map stays as it is
  for (const Metric& metric : chosen_metrics(config.metrics))
    if (metric.constant_varies) varying.names.push_back(metric.name);
  if (varying.names.empty()) return;
  const std::vector<Metric> metrics = chosen_metrics(varying);
  catalog.add(
      shape.shapes, {fmt::format("scores.{}", kConstantMap), scores_version(metrics)},
      [metrics, of_positions = any_of_positions(metrics)](const GroundTruth& truth, Points points,
                                                          Surface surface, const MetricsOptions& options) {
        return score(metrics, ScalarField(points.size(), 0.5), truth, options, Rng(0, "", ""),
                     barycentric_areas(points, surface), centre_bias_if(of_positions, points));
      },
      shape.ground_truth, shape.points, only_if(any_by_area(metrics), shape.surface),
      section("metrics", varying));
}

void add_model(Catalog& catalog, const ShapeRows& shape, const Config& config, const Model& model) {
  const RowHead map_head{"map." + model.name, model.version};
  const RowHead matched_head{"matched." + model.name, 1};
  if (model.given && model.given->matched) {
    const RowOf<ScalarField> given = add_given_map(catalog, shape, model, matched_head);
    add_scores(catalog, shape, config, model, given, given);
    return;
  }
  const RowOf<ScalarField> map =
      model.given ? add_given_map(catalog, shape, model, map_head) : model.add_map(catalog, shape, map_head);
  const auto match = [](const ScalarField& values, const Histogram& reference) {
    return matched(values, reference);
  };
  add_scores(catalog, shape, config, model, map,
             catalog.add(shape.shapes, matched_head, match, map, shape.reference));
  catalog.add(shape.shapes, {"mean_histogram." + model.name, 1}, mean_over<ScalarField>, map);
}

RowOf<GroundTruth> add_mesh_ground_truth(Catalog& catalog, const Config& config, const RowOf<Mesh>& mesh) {
  if (config.simulated())
    return catalog.add(Shapes::meshes, {"ground_truth", 1}, simulate_ground_truth, mesh,
                       section("simulation", config.simulation), kRandom);
  return catalog.add(Shapes::meshes, {"ground_truth", 1}, given_truth, mesh, kFiles<Source::truth_files>);
}

RowOf<GroundTruth> add_cloud_ground_truth(Catalog& catalog, const Config& config,
                                          const RowOf<PointCloud>& cloud, const RowOf<Surface>& surface) {
  if (config.simulated())
    return catalog.add(Shapes::clouds, {"cloud_ground_truth", 1}, made_up_cloud_ground_truth, cloud, surface,
                       section("simulation", config.simulation), kRandom);
  return catalog.add(Shapes::clouds, {"cloud_ground_truth", 1}, given_cloud_truth, cloud, surface,
                     kFiles<Source::truth_files>);
}

RowOf<Histogram> add_reference(Catalog& catalog, Shapes shapes, const RowOf<GroundTruth>& truth,
                               const std::optional<Histogram>& given) {
  const auto row = catalog.add(shapes, {"reference", 1}, mean_over<GroundTruth>, truth);
  if (given) catalog.rows[row.row].given = std::make_shared<const Value>(*given);
  return row;
}

RowOf<Descriptors> add_fpfh(Catalog& catalog, const ShapeRows& shape, const SectionOf<FpfhOptions>& chosen) {
  const auto describe = [](Points points, const Normals& normals, const FpfhOptions& options) {
    return fpfh(points, normals, options);
  };
  return catalog.add(shape.shapes, {"fpfh", 1}, describe, shape.points, shape.normals, chosen);
}

// From its points on, a cloud is described like the vertices of a mesh: with the same normals, both have the
// same maps. What needs faces takes a partial mesh, as for scans.
RowOf<PointCloud> add_cloud(Catalog& catalog, const Config& config, const std::optional<Histogram>& given,
                            ShapeRows& clouds) {
  const auto cloud =
      catalog.add(Shapes::clouds, {"cloud", 1}, load_cloud, kFiles<Source::shape_file>, kRemark);
  clouds.points = cloud;
  const RowOf<Normals> normals = catalog.add(Shapes::clouds, {"cloud_normals", 1}, cloud_normals, cloud,
                                             section("scan_normals", config.scan_normals));
  clouds.normals = normals;
  clouds.surface = catalog.add(Shapes::clouds, {"surface", 1}, partial_mesh, cloud, normals,
                               section("surface", config.surface));
  clouds.ground_truth = add_cloud_ground_truth(catalog, config, cloud, clouds.surface);
  clouds.reference = add_reference(catalog, Shapes::clouds, clouds.ground_truth, given);
  clouds.fpfh = add_fpfh(catalog, clouds, section("fpfh", config.fpfh));
  return cloud;
}

template <class Function, class... Inputs>
void add_picture(Catalog& catalog, const Config& config, Shapes shapes, const Function& picture,
                 const Inputs&... inputs) {
  RowHead head{"picture", 1};
  head.only_if_cached = config.pictures == Pictures::cached;
  catalog.add(shapes, head, picture, inputs..., section("picture", config.picture), kRandom);
}

// One per row of scores, of maps and of people alike: results are read from a few files, not from thousands.
void add_score_tables(Catalog& catalog) {
  for (std::size_t row = 0, n = catalog.rows.size(); row < n; ++row) {
    if (catalog.rows[row].kind != "scores") continue;
    const auto [name, shapes] = std::pair(catalog.rows[row].name, catalog.rows[row].shapes);
    catalog.add(shapes, {"score_table" + name.substr(name.find('.')), 1}, score_table, RowOf<Scores>(row));
  }
}

}  // namespace

Catalog make_catalog(const Config& config, const std::optional<Histogram>& given_reference,
                     const DataKinds& kinds) {
  Catalog catalog;
  ShapeRows meshes{.shapes = Shapes::meshes}, scans{.shapes = Shapes::scans},
      clouds{.shapes = Shapes::clouds};
  const bool on_meshes = kinds.meshes && config.dataset.meshes,
             on_scans = kinds.meshes && config.dataset.scans;

  RowOf<Mesh> mesh;
  if (kinds.meshes) {
    mesh = catalog.add(Shapes::meshes, {"mesh", 2}, load_mesh, kFiles<Source::shape_file>, kRemark);
    meshes.points = mesh;
    meshes.surface = mesh;
    meshes.ground_truth = add_mesh_ground_truth(catalog, config, mesh);
    meshes.reference = add_reference(catalog, Shapes::meshes, meshes.ground_truth, given_reference);
  }
  RowOf<Scan> scan;
  if (on_scans) {
    scan = catalog.add(Shapes::scans, {"scan", 1}, scan_of, prepared<ScanScene>(mesh), kView,
                       section("scan", config.scan));
    scans.points = scan;
    scans.ground_truth = catalog.add(Shapes::scans, {"scan_ground_truth", 1}, scan_ground_truth, scan, mesh,
                                     meshes.ground_truth);
    scans.reference = add_reference(catalog, Shapes::scans, scans.ground_truth, given_reference);
  }

  if (on_meshes) {
    meshes.normals =
        catalog.add(Shapes::meshes, {"normals", 1}, mesh_normals, mesh, section("normals", config.normals));
    meshes.fpfh = add_fpfh(catalog, meshes, section("fpfh", config.fpfh));
  }
  if (on_scans) {
    scans.normals = catalog.add(Shapes::scans, {"scan_normals", 1}, scan_normals, scan,
                                section("scan_normals", config.scan_normals));
    scans.surface = catalog.add(Shapes::scans, {"surface", 1}, partial_mesh, scan, scans.normals,
                                section("surface", config.surface));
    scans.fpfh = add_fpfh(catalog, scans, section<FpfhOptions>("scan_fpfh", config.scan_fpfh));
  }
  RowOf<PointCloud> cloud;
  if (kinds.clouds) cloud = add_cloud(catalog, config, given_reference, clouds);

  for (const Model& model : config.models) {
    if (model.human && on_meshes) add_human_performance(catalog, meshes, mesh, config, model);
    if (model.is_map() && on_meshes) add_model(catalog, meshes, config, model);
    if (model.is_map() && on_scans) add_model(catalog, scans, config, model);
    if (model.is_map() && kinds.clouds) add_model(catalog, clouds, config, model);
  }
  if (on_meshes) add_constant_scores(catalog, meshes, config);
  if (on_scans) add_constant_scores(catalog, scans, config);
  if (kinds.clouds) add_constant_scores(catalog, clouds, config);
  if (config.pictures != Pictures::none) {
    if (on_meshes) add_picture(catalog, config, Shapes::meshes, picture_of_mesh, mesh);
    if (on_scans) add_picture(catalog, config, Shapes::scans, picture_of_scan, scan, scans.normals, mesh);
    if (kinds.clouds)
      add_picture(catalog, config, Shapes::clouds, picture_of_cloud, cloud, clouds.normals, clouds.surface);
  }
  add_score_tables(catalog);
  return catalog;
}

std::string node_name(const Row& row) { return fmt::format("{} of {}", row.name, name_of(row.shapes)); }

std::string option_path(const Row& row, std::string_view key) {
  const std::string line = fmt::format("\n{}: ", key);
  for (const OptionLines& options : row.options)
    if (("\n" + options.text).find(line) != std::string::npos)
      return fmt::format("{}.{}", options.section, key);
  return std::string(key);
}

std::vector<bool> ancestors(const Catalog& catalog, const std::vector<std::size_t>& rows) {
  std::vector<bool> needed(catalog.rows.size(), false);
  for (const std::size_t row : rows) needed[row] = true;
  for (std::size_t row = needed.size(); row-- > 0;)
    if (needed[row] && !catalog.rows[row].given)
      for (const std::size_t input : catalog.rows[row].inputs) needed[input] = true;
  return needed;
}

bool Catalog::has(Shapes shapes, std::string_view name) const {
  return std::any_of(rows.begin(), rows.end(),
                     [&](const Row& row) { return row.shapes == shapes && row.name == name; });
}

bool Catalog::reference_is_given() const {
  return std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.given != nullptr; });
}

std::size_t Catalog::index(Shapes shapes, std::string_view name) const {
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (rows[row].shapes == shapes && rows[row].name == name) return row;
  throw std::out_of_range(fmt::format("the catalog has no row '{}' for {}", name, name_of(shapes)));
}

}  // namespace salbench
