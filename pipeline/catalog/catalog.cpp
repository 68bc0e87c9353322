// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/catalog.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/mesh_file.h"
#include "pipeline/catalog/given_maps.h"
#include "pipeline/catalog/given_truth.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_check.h"
#include "stages/core/seen.h"
#include "stages/ground_truth/scan_truth.h"
#include "stages/matching/matching.h"
#include "stages/picture/picture.h"

namespace salbench {
namespace {

// --- functions of rows that are more than one stage's ------------------------------------------------------

Mesh load_mesh(const FilesOf<Source::mesh_file>& file) {
  CheckedMesh checked = check_mesh(parse_mesh(file.data[0].text(), file.item.mesh));
  for (const std::string& warning : warnings(checked.report)) spdlog::warn("{}: {}", file.name, warning);
  return std::move(checked.mesh);
}

GroundTruth made_up_ground_truth(const Mesh& mesh, const SimulationOptions& options,
                                 const RandomSource& random) {
  return simulated_ground_truth(mesh, options, random.seed, random.item);
}

Scan scan_of(const Mesh& mesh, const View& view, const ScanOptions& options) {
  return simulate_scan(mesh, view.index, options);
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
    if (!values.empty()) histograms.push_back(normalised_histogram(values));  // a scan may show nothing known
  }
  return mean_histogram(histograms);
}

ScalarField matched_where_seen(const ScalarField& map, const Histogram& reference) {
  const auto seen = seen_points(map);
  if (!seen) return matched(map, reference);
  ScalarField result = map;
  const ScalarField values = matched(values_at(map, *seen), reference);
  for (std::size_t i = 0; i < values.size(); ++i) result[static_cast<std::size_t>((*seen)[i])] = values[i];
  return result;
}

// A group's map is matched like a model's, and so is the map of the others, which stands for the ground
// truth. What either group has not seen is not compared.
GroupScorer group_scorer(const Mesh& mesh, const Histogram& reference, const MetricsOptions& options,
                         const Rng& rng) {
  const std::vector<Metric> metrics = chosen_metrics(options);
  const ScalarField areas =
      any_by_area(metrics) ? barycentric_areas(mesh.vertices, mesh.faces) : ScalarField{};
  return {metrics.size(), [=](const ScalarField& map, const GroundTruth& others) {
            const ScalarField matched_map = matched_where_seen(map, reference);
            GroundTruth matched_others{matched_where_seen(others.saliency, reference), others.picks,
                                       others.simulated};
            for (std::size_t i = 0; i < matched_map.size(); ++i)
              if (std::isnan(matched_map[i])) matched_others.saliency[i] = matched_map[i];
            return score(metrics, matched_map, matched_others, options, rng, areas);
          }};
}

std::function<bool(const DatasetItem&)> participants_of(const Config& config) {
  if (!config.simulated()) return has_participants;
  const bool enough = static_cast<std::size_t>(config.simulation.participants) >= kMinParticipants;
  return [enough](const DatasetItem&) { return enough; };
}

// --- groups of rows ----------------------------------------------------------------------------------------

// A map from outside in place of a computed one. The points are read for their number alone.
RowOf<ScalarField> add_given_map(Catalog& catalog, const ShapeRows& shape, const Model& model, RowHead head) {
  return catalog.add(
      shape.shapes, std::move(head),
      [maps = model.given](Points points, const FilesOf<Source::map_file>& file) {
        return maps->checked(file.data[0], file.name, points.size());
      },
      shape.points, kFiles<Source::map_file>);
}

void add_scores(Catalog& catalog, const ShapeRows& shape, const Config& config, const Model& model,
                RowOf<ScalarField> matched_map) {
  const std::string name = "scores." + model.name;
  const std::vector<Metric> metrics = chosen_metrics(config.metrics);
  const RowHead head{name, scores_version(metrics)};
  const auto options = section("metrics", config.metrics);
  if (!any_by_area(metrics)) {
    catalog.add(
        shape.shapes, head,
        [name](const ScalarField& map, const GroundTruth& truth, const MetricsOptions& chosen,
               const RandomSource& random) { return score(map, truth, chosen, random.rng(name)); },
        matched_map, shape.ground_truth, options, kRandom);
    return;
  }
  // Only what needs areas reads the surface: other scores are found whatever it is.
  catalog.add(
      shape.shapes, head,
      [name](const ScalarField& map, const GroundTruth& truth, Points points, Surface surface,
             const MetricsOptions& chosen, const RandomSource& random) {
        return score(map, truth, chosen, random.rng(name), barycentric_areas(points, surface));
      },
      matched_map, shape.ground_truth, shape.points, shape.surface, options, kRandom);
}

void add_model(Catalog& catalog, const ShapeRows& shape, const Config& config, const Model& model) {
  const RowHead map_head{"map." + model.name, model.version};
  const RowHead matched_head{"matched." + model.name, 1};
  if (model.given && model.given->matched) {
    add_scores(catalog, shape, config, model, add_given_map(catalog, shape, model, matched_head));
    return;
  }
  const RowOf<ScalarField> map =
      model.given ? add_given_map(catalog, shape, model, map_head) : model.add_map(catalog, shape, map_head);
  const auto match = [](const ScalarField& values, const Histogram& reference) {
    return matched(values, reference);
  };
  add_scores(catalog, shape, config, model,
             catalog.add(shape.shapes, matched_head, match, map, shape.reference));
  catalog.add(shape.shapes, {"mean_histogram." + model.name, 1}, mean_over<ScalarField>, map);
}

// HS has no map: its scores come from the participants, who saw meshes only.
void add_human_performance(Catalog& catalog, const ShapeRows& shape, const RowOf<Mesh>& mesh,
                           const Config& config, const Model& model) {
  const std::string scores = "scores." + model.name, curve = "curve." + model.name;
  const std::int32_t version =
      model.version + scores_version(chosen_metrics(config.metrics)) - 1;  // grows with either
  catalog.add(
      Shapes::meshes, {scores, version, participants_of(config)},
      [scores](const Mesh& shape_of, const GroundTruth& truth, const Histogram& reference,
               const MetricsOptions& options, const RandomSource& random) {
        return leave_one_out(shape_of, truth, group_scorer(shape_of, reference, options, random.rng(scores)));
      },
      mesh, shape.ground_truth, shape.reference, section("metrics", config.metrics), kRandom);
  catalog.add(
      Shapes::meshes, {curve, version, participants_of(config)},
      [scores, curve](const Mesh& shape_of, const GroundTruth& truth, const Histogram& reference,
                      const HsOptions& options, const MetricsOptions& metrics, const RandomSource& random) {
        return human_curve(shape_of, truth, options,
                           group_scorer(shape_of, reference, metrics, random.rng(scores)), random.rng(curve));
      },
      mesh, shape.ground_truth, shape.reference, section("models." + model.name, *model.human),
      section("metrics", config.metrics), kRandom);
}

RowOf<GroundTruth> add_mesh_ground_truth(Catalog& catalog, const Config& config, const RowOf<Mesh>& mesh) {
  if (config.simulated())
    return catalog.add(Shapes::meshes, {"ground_truth", 1}, made_up_ground_truth, mesh,
                       section("simulation", config.simulation), kRandom);
  return catalog.add(Shapes::meshes, {"ground_truth", 1}, given_truth, mesh, kFiles<Source::truth_files>);
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

void add_pictures(Catalog& catalog, const Config& config, const RowOf<Mesh>& mesh, const RowOf<Scan>& scan,
                  const RowOf<Normals>& scan_normals) {
  RowHead head{"picture", 1};
  head.only_if_cached = config.pictures == Pictures::cached;
  const auto options = section("picture", config.picture);
  if (config.dataset.meshes) catalog.add(Shapes::meshes, head, picture_of_mesh, mesh, options, kRandom);
  if (config.dataset.scans)
    catalog.add(Shapes::scans, head, picture_of_scan, scan, scan_normals, mesh, options, kRandom);
}

}  // namespace

Catalog make_catalog(const Config& config, const std::optional<Histogram>& given_reference) {
  Catalog catalog;
  ShapeRows meshes{.shapes = Shapes::meshes}, scans{.shapes = Shapes::scans};

  const RowOf<Mesh> mesh = catalog.add(Shapes::meshes, {"mesh", 1}, load_mesh, kFiles<Source::mesh_file>);
  meshes.points = mesh;
  meshes.surface = mesh;
  meshes.ground_truth = add_mesh_ground_truth(catalog, config, mesh);
  meshes.reference = add_reference(catalog, Shapes::meshes, meshes.ground_truth, given_reference);

  RowOf<Scan> scan;
  if (config.dataset.scans) {
    scan = catalog.add(Shapes::scans, {"scan", 1}, scan_of, mesh, kView, section("scan", config.scan));
    scans.points = scan;
    scans.ground_truth = catalog.add(Shapes::scans, {"scan_ground_truth", 1}, scan_ground_truth, scan, mesh,
                                     meshes.ground_truth);
    scans.reference = add_reference(catalog, Shapes::scans, scans.ground_truth, given_reference);
  }

  if (config.dataset.meshes) {
    meshes.normals =
        catalog.add(Shapes::meshes, {"normals", 1}, mesh_normals, mesh, section("normals", config.normals));
    meshes.fpfh = add_fpfh(catalog, meshes, section("fpfh", config.fpfh));
  }
  if (config.dataset.scans) {
    scans.normals = catalog.add(Shapes::scans, {"scan_normals", 1}, scan_normals, scan,
                                section("scan_normals", config.scan_normals));
    scans.surface = catalog.add(Shapes::scans, {"surface", 1}, partial_mesh, scan, scans.normals,
                                section("surface", config.surface));
    scans.fpfh = add_fpfh(catalog, scans, section<FpfhOptions>("scan_fpfh", config.scan_fpfh));
  }

  for (const Model& model : config.models) {
    if (model.human && config.dataset.meshes) add_human_performance(catalog, meshes, mesh, config, model);
    if (model.is_map() && config.dataset.meshes) add_model(catalog, meshes, config, model);
    if (model.is_map() && config.dataset.scans) add_model(catalog, scans, config, model);
  }
  if (config.pictures != Pictures::none) add_pictures(catalog, config, mesh, scan, scans.normals);
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
