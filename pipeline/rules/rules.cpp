// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/rules.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/package/importer.h"
#include "pipeline/rules/human.h"
#include "stages/core/centre.h"
#include "stages/core/field.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/point_cloud.h"
#include "stages/core/seen.h"
#include "stages/ground_truth/scan_truth.h"
#include "stages/ground_truth/simulation.h"
#include "stages/matching/matching.h"
#include "stages/metrics/laplacian.h"
#include "stages/picture/picture.h"

namespace salbench {
namespace {

// --- functions of rules that are more than one stage's ----------------------------------------------------

GroundTruth simulate_ground_truth(const Mesh& mesh, const SimulationOptions& options,
                                  const RandomSource& random) {
  return simulated_ground_truth(mesh, options, random.seed, random.item);
}

GroundTruth made_up_cloud_ground_truth(const PointCloud& cloud, Surface surface,
                                       const SimulationOptions& options, const RandomSource& random) {
  return simulate_ground_truth(mesh_of(cloud, surface), options, random);
}

Scan scan_of(const ScanScene& scene, const UnitPlace& view, const ScanOptions& options) {
  return scene.scan(static_cast<int>(view.index), options);
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
    const auto member = members[i];
    const auto& values = seen_values(*member);
    // A scan may show nothing known. An infinite value fails stages of its own item, and nothing here.
    if (!values.empty() && std::ranges::none_of(values, [](double value) { return std::isinf(value); }))
      histograms.push_back(normalised_histogram(values));
  }
  return mean_histogram(histograms);
}

CentreDensity sum_of_densities(const Members<CentreDensity>& members) {
  CentreDensity sum;
  for (std::size_t i = 0; i < members.size; ++i) add(sum, *members[i]);
  return sum;
}

ScoreTable score_table(const Members<Scores>& members) {
  ScoreTable table;
  for (std::size_t i = 0; i < members.size; ++i) table.rows.push_back(*members[i]);
  return table;
}

ScoreTable one_after_the_other(const Members<ScoreTable>& members) {
  ScoreTable table;
  for (std::size_t i = 0; i < members.size; ++i) {
    const auto member = members[i];
    table.rows.insert(table.rows.end(), member->rows.begin(), member->rows.end());
  }
  return table;
}

// --- groups of rules ---------------------------------------------------------------------------------------

// Only where a metric asks for it: of other configurations no job, and no key, knows of it.
void add_centre_densities(RuleTable& table, ShapeOutputs& shape, const Config& config) {
  if (!any_of_others(chosen_metrics(config.metrics))) return;
  shape.centre_density = table.add(shape.level, stage(Role::centre_density, 1), centre_density, shape.points,
                                   shape.ground_truth);
  shape.centre_densities = table.add<CentreDensities>(shape.level, stage(Role::centre_densities, 1),
                                                      sum_of_densities, shape.centre_density);
}

// Reads the map in the readings that the metrics ask for, and the surface where they weigh by area: other
// scores are found whatever these are.
void add_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config, const Model& model,
                const Output<FieldView>& map, const Output<Matched>& matched_map) {
  const auto metrics = std::make_shared<const MetricsByMatching>(config.metrics);
  RuleHead head = stage_of(model.name, Role::scores, scores_version(metrics->all()));
  table.add(
      shape.level, head,
      [name = head.stage, metrics](FieldView matched_values, FieldView values, const GroundTruth& truth,
                                   Points points, Surface surface, const CentreDensity* own,
                                   const CentreDensity* set, const MetricsOptions& options,
                                   const RandomSource& random) {
        Draws draws(random.rng(name));
        const Measures measures = measures_of(metrics->all(), std::max(matched_values.size(), values.size()),
                                              points, surface, density_if_known(points, own, set));
        return metrics->score([&](std::span<const Metric> of_part, Matching read) {
          return read == Matching::histogram
                     ? score(of_part, matched_values, truth, options, draws, measures)
                     : score(of_part, min_max_normalised(values), truth, options, draws, measures);
        });
      },
      only_if<FieldView>(metrics->any(Matching::histogram), matched_map),
      only_if(metrics->any(Matching::none), map), shape.ground_truth,
      only_if(any_of_points(metrics->all()), shape.points),
      only_if(any_of_faces(metrics->all()), shape.surface), shape.centre_density, shape.centre_densities,
      section("metrics", config.metrics), kRandom);
}

// Scores of a constant map by the metrics that score it otherwise on each shape: what models are compared
// with in remarks.
void add_constant_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config) {
  MetricsOptions varying = config.metrics;
  varying.names.clear();
  varying.matching.clear();  // a constant map stays as it is
  for (const Metric& metric : chosen_metrics(config.metrics))
    if (metric.constant_varies) varying.names.push_back(metric.name);
  if (varying.names.empty()) return;
  const std::vector<Metric> metrics = chosen_metrics(varying);
  table.add(
      shape.level, stage_of(std::string(kConstantMap), Role::scores, scores_version(metrics)),
      [metrics](const GroundTruth& truth, Points points, Surface surface, const MetricsOptions& options) {
        Draws draws(Rng(0, "", ""));
        return score(metrics, ScalarField(points.size(), 0.5), truth, options, draws,
                     measures_of(metrics, points.size(), points, surface));
      },
      shape.ground_truth, shape.points, only_if(any_of_faces(metrics), shape.surface),
      section("metrics", varying));
}

// The scores of a map after each number of smoothing steps, with the draws of the plain scores. They stand
// beside all else, and nothing reads them.
void add_smoothed_scores(RuleTable& table, const ShapeOutputs& shape, const MetricsOptions& chosen,
                         const Model& model, const Output<FieldView>& map) {
  const auto metrics = std::make_shared<const MetricsByMatching>(chosen);
  const bool match = metrics->any(Matching::histogram) && !(model.given && model.given->matched);
  const auto scored = table.add(
      shape.level, stage_of(model.name, Role::smoothed_scores, scores_version(metrics->all())),
      [name = stage_of(model.name, Role::scores, 1).stage, metrics](
          FieldView plain, const GroundTruth& truth, Points points, Surface surface,
          const Histogram* reference, const CentreDensity* own, const CentreDensity* set,
          const MetricsOptions& options, const RandomSource& random) {
        const Measures measures =
            measures_of(metrics->all(), points.size(), points, surface, density_if_known(points, own, set));
        const Adjacency adjacency = edge_adjacency(points.size(), surface);
        ScalarField values(plain.begin(), plain.end());
        for (double& value : values)
          if (std::isnan(value)) value = 0;  // as matching and normalisation have it
        ScoreTable by_steps;
        std::int32_t done = 0;
        for (const std::int32_t steps : smoothing_steps(options)) {
          values = smoothed_by_steps(std::move(values), adjacency, steps - std::exchange(done, steps));
          Draws draws(random.rng(name));
          by_steps.rows.push_back(metrics->score([&](std::span<const Metric> of_part, Matching read) {
            const bool to_match = read == Matching::histogram && reference != nullptr;
            return score(of_part, to_match ? matched(values, *reference) : min_max_normalised(values), truth,
                         options, draws, measures);
          }));
        }
        return by_steps;
      },
      map, shape.ground_truth, shape.points, shape.surface,
      only_if(match, Output<Histogram>(shape.reference.rule)), shape.centre_density, shape.centre_densities,
      section("metrics", chosen), kRandom);
  table.add(shape.level, stage_of(model.name, Role::smoothed_table, 1), one_after_the_other, scored);
}

void add_model(RuleTable& table, const ShapeOutputs& shape, const Config& config,
               const MetricsOptions& smoothing, const Model& model) {
  const auto match = [](const ScalarField& values, const Histogram& reference) {
    return matched(values, reference);
  };
  const Output<Map> map = model.add_map(table, shape);
  if (!smoothing.smoothing.empty()) add_smoothed_scores(table, shape, smoothing, model, map);
  if (model.given && model.given->matched)
    return add_scores(table, shape, config, model, map, Output<Matched>(map.rule));
  add_scores(
      table, shape, config, model, map,
      table.add<Matched>(shape.level, stage_of(model.name, Role::matched, 1), match, map, shape.reference));
  table.add(shape.level, stage_of(model.name, Role::mean_histogram, 1), mean_over<ScalarField>, map);
}

// Files of a data set, and what reads them.
struct Source {
  const Inputs& inputs;
  std::shared_ptr<Importer> importer;

  bool imports() const { return inputs.importer.version > 0; }
};

// Files in the one form that another program wrote are read as this one writes them.
template <class Read>
auto in_own_form(const std::shared_ptr<Importer>& importer, const Files& files, const Read& read) try {
  return read(files);
} catch (const ForeignForm&) {
  const std::vector<FileData> own = importer->rewritten(files);
  return read(Files{files.source, files.name, own});
}

// Where the list of a data set names an importer, all that follows reads what it made.
Output<ShapeInForm> add_import(RuleTable& table, Level level, const Source& source) {
  return table.add(
      level, stage(Role::import, source.inputs.importer.version),
      [importer = source.importer](const Files& files) { return importer->item(files); },
      FilesOf{source.inputs.shape_files});
}

Output<Mesh> add_mesh(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 2, "mesh");
  if (source.imports())
    return table.add(
        kMeshes, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_mesh(shape.mesh, shape.polygons, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kMeshes, head,
      [importer = source.importer](const Files& files, const Remark& remark) {
        return in_own_form(importer, files, [&](const Files& own) { return load_mesh(own, remark); });
      },
      FilesOf{source.inputs.shape_files}, kRemark);
}

Output<PointCloud> add_points(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 1, "cloud");
  if (source.imports())
    return table.add(
        kClouds, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_cloud(shape.cloud, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kClouds, head,
      [importer = source.importer](const Files& files, const Remark& remark) {
        return in_own_form(importer, files, [&](const Files& own) { return load_cloud(own, remark); });
      },
      FilesOf{source.inputs.shape_files}, kRemark);
}

Output<GroundTruth> add_mesh_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                          const Output<Mesh>& mesh, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1);
  const FilesOf files{source.inputs.truth_files};
  if (config.simulated())
    return table.add(kMeshes, head, simulate_ground_truth, mesh, section("simulation", config.simulation),
                     kRandom);
  if (source.imports()) return table.add(kMeshes, head, imported_truth, mesh, form, files);
  return table.add(
      kMeshes, head,
      [importer = source.importer](const Mesh& shape, const Files& given) {
        return in_own_form(importer, given, [&](const Files& own) { return given_truth(shape, own); });
      },
      mesh, files);
}

Output<GroundTruth> add_cloud_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                           const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                           const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1, "cloud_ground_truth");
  const FilesOf files{source.inputs.truth_files};
  if (config.simulated())
    return table.add(kClouds, head, made_up_cloud_ground_truth, cloud, surface,
                     section("simulation", config.simulation), kRandom);
  if (source.imports())
    return table.add(
        kClouds, head,
        [](const PointCloud& points, Surface faces, const ShapeInForm& shape, const Files& given) {
          return imported_truth(mesh_of(points, faces), shape, given);
        },
        cloud, surface, form, files);
  return table.add(
      kClouds, head,
      [importer = source.importer](const PointCloud& points, Surface faces, const Files& given) {
        return in_own_form(importer, given,
                           [&](const Files& own) { return given_cloud_truth(points, faces, own); });
      },
      cloud, surface, files);
}

// A given reference is known before the run, and reads nothing.
Output<Reference> add_reference(RuleTable& table, Level level, const Output<GroundTruth>& truth,
                                const std::optional<Histogram>& given) {
  const auto reference =
      table.add<Reference>(level, stage(Role::reference, 1), mean_over<GroundTruth>, truth);
  if (given) {
    table[reference.rule].given = held(*given);
    table[reference.rule].inputs.clear();
  }
  return reference;
}

Output<Descriptors> add_fpfh(RuleTable& table, const ShapeOutputs& shape,
                             const SectionOf<FpfhOptions>& chosen) {
  const auto describe = [](Points points, const Normals& normals, const FpfhOptions& options) {
    return fpfh(points, normals, options);
  };
  return table.add(shape.level, stage(Role::fpfh, 1), describe, shape.points, shape.normals, chosen);
}

// From its points on, a cloud is described like the vertices of a mesh: with the same normals, both have the
// same maps. What needs faces takes a partial mesh, as for scans.
Output<PointCloud> add_cloud(RuleTable& table, const Config& config, const Source& source,
                             const std::optional<Histogram>& given, ShapeOutputs& clouds) {
  const auto form = source.imports() ? add_import(table, kClouds, source) : Output<ShapeInForm>();
  const Output<PointCloud> cloud = add_points(table, source, form);
  clouds.points = cloud;
  const Output<Normals> normals = table.add(kClouds, stage(Role::normals, 1, "cloud_normals"), cloud_normals,
                                            cloud, section("scan_normals", config.scan_normals));
  clouds.normals = normals;
  clouds.surface = table.add(kClouds, stage(Role::surface, 1), partial_mesh, cloud, normals,
                             section("surface", config.surface));
  clouds.ground_truth = add_cloud_ground_truth(table, config, source, cloud, clouds.surface, form);
  clouds.reference = add_reference(table, kClouds, clouds.ground_truth, given);
  clouds.fpfh = add_fpfh(table, clouds, section("fpfh", config.fpfh));
  return cloud;
}

template <class Function, class... Arguments>
void add_picture(RuleTable& table, const Config& config, Level level, const Function& picture,
                 const Arguments&... arguments) {
  RuleHead head = stage(Role::picture, 1);
  head.only_if_cached = config.pictures == Pictures::cached;
  table.add(level, head, picture, arguments..., section("picture", config.picture), kRandom);
}

void give_map_files(const std::vector<ShapeOutputs*>& shapes, const Units& units,
                    const std::shared_ptr<const GivenMaps>& maps) {
  std::vector<Level> levels;
  for (const ShapeOutputs* shape : shapes) levels.push_back(shape->level);
  const auto columns = map_files(maps, units, levels);
  for (ShapeOutputs* shape : shapes) shape->map_files = columns.at(shape->level);
}

// One per rule of scores, of maps and of people alike: results are read from a few files, not from thousands.
void add_score_tables(RuleTable& table) {
  for (std::size_t rule = 0, n = table.rules().size(); rule < n; ++rule)
    if (const Rule& scores = table.rules()[rule]; has_role(scores, Role::scores))
      table.add(scores.over, stage_of(scores.subject, Role::score_table, 1), score_table,
                Output<Scores>(rule));
}

}  // namespace

Rules make_rules(const Config& with_smoothing, const Inputs& inputs,
                 const std::optional<Histogram>& given_reference) {
  Config config = with_smoothing;  // plain scores are the same with it and without
  config.metrics.smoothing.clear();
  RuleTable table;
  ShapeOutputs meshes{.level = kMeshes}, scans{.level = kScans}, clouds{.level = kClouds};
  const bool any_mesh = inputs.has(kMeshes), any_cloud = inputs.has(kClouds);
  const bool on_meshes = any_mesh && config.dataset.meshes, on_scans = any_mesh && config.dataset.scans;

  const Source source{inputs, std::make_shared<Importer>(inputs.importer)};
  Output<Mesh> mesh;
  if (any_mesh) {
    const auto form = source.imports() ? add_import(table, kMeshes, source) : Output<ShapeInForm>();
    mesh = add_mesh(table, source, form);
    meshes.points = mesh;
    meshes.surface = mesh;
    meshes.ground_truth = add_mesh_ground_truth(table, config, source, mesh, form);
    meshes.reference = add_reference(table, kMeshes, meshes.ground_truth, given_reference);
  }
  Output<Scan> scan;
  if (on_scans) {
    scan = table.add(kScans, stage(Role::shape, 1, "scan"), scan_of, prepared<ScanScene>(mesh), kPlace,
                     section("scan", config.scan));
    scans.points = scan;
    scans.ground_truth = table.add(kScans, stage(Role::ground_truth, 1, "scan_ground_truth"),
                                   scan_ground_truth, scan, mesh, meshes.ground_truth);
    scans.reference = add_reference(table, kScans, scans.ground_truth, given_reference);
  }

  if (on_meshes) {
    meshes.normals =
        table.add(kMeshes, stage(Role::normals, 1), mesh_normals, mesh, section("normals", config.normals));
    meshes.fpfh = add_fpfh(table, meshes, section("fpfh", config.fpfh));
  }
  if (on_scans) {
    scans.normals = table.add(kScans, stage(Role::normals, 1, "scan_normals"), scan_normals, scan,
                              section("scan_normals", config.scan_normals));
    scans.surface = table.add(kScans, stage(Role::surface, 1), partial_mesh, scan, scans.normals,
                              section("surface", config.surface));
    scans.fpfh = add_fpfh(table, scans, section<FpfhOptions>("scan_fpfh", config.scan_fpfh));
  }
  Output<PointCloud> cloud;
  if (any_cloud) cloud = add_cloud(table, config, source, given_reference, clouds);

  std::vector<ShapeOutputs*> evaluated;
  if (on_meshes) evaluated.push_back(&meshes);
  if (on_scans) evaluated.push_back(&scans);
  if (any_cloud) evaluated.push_back(&clouds);
  for (ShapeOutputs* shape : evaluated) add_centre_densities(table, *shape, config);
  for (const Model& model : config.models) {
    if (model.human && on_meshes) add_human_performance(table, meshes, mesh, config, model);
    if (model.given) give_map_files(evaluated, inputs.units, model.given);
    for (const ShapeOutputs* shape : evaluated)
      if (!model.human) add_model(table, *shape, config, with_smoothing.metrics, model);
  }
  for (const ShapeOutputs* shape : evaluated) add_constant_scores(table, *shape, config);
  if (config.pictures != Pictures::none) {
    if (on_meshes) add_picture(table, config, kMeshes, picture_of_mesh, mesh);
    if (on_scans) add_picture(table, config, kScans, picture_of_scan, scan, scans.normals, mesh);
    if (any_cloud)
      add_picture(table, config, kClouds, picture_of_cloud, cloud, clouds.normals, clouds.surface);
  }
  add_score_tables(table);
  return std::move(table).take();
}

Project make_project(const Config& config, const Inputs& inputs,
                     const std::optional<Histogram>& given_reference) {
  Attributes attributes = {{"protocol", std::string(name_of(config.protocol))}};
  if (config.simulated()) attributes.emplace_back("participants", std::string(kSimulatedNote));
  Project project{.rules = make_rules(config, inputs, given_reference),
                  .units = inputs.units,
                  .seed = config.seed,
                  .attributes = std::move(attributes),
                  .is_share = inputs.shard.has_value()};
  std::vector<std::size_t> references;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    if (has_role(project.rules[rule], Role::reference)) references.push_back(rule);
  const std::vector<bool> read_by_them = project.ancestors(references);
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    project.rules[rule].for_all = read_by_them[rule] && !project.rules[rule].gathers;
  return project;
}

bool reference_is_given(const Rules& rules) {
  return std::ranges::any_of(rules, [](const Rule& rule) { return rule.given != nullptr; });
}

std::string node_name(const Rule& rule) {
  return fmt::format("{} of {}", rule.stage, shapes_name(rule.over));
}

std::string option_path(const Rule& rule, std::string_view key) {
  const std::string line = fmt::format("\n{}: ", key);
  for (const OptionLines& options : rule.options)
    if (("\n" + options.text).find(line) != std::string::npos)
      return fmt::format("{}.{}", options.section, key);
  return std::string(key);
}

}  // namespace salbench
