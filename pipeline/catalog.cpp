#include "pipeline/catalog.h"

#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/ground_truth_file.h"
#include "io/mesh_file.h"
#include "pipeline/given_maps.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_check.h"
#include "stages/core/smoothing.h"
#include "stages/ground_truth/scan_truth.h"
#include "stages/matching/matching.h"

namespace salbench {
namespace {

// --- the functions of the rows -------------------------------------------------------------------------

Value load_mesh(const StageInputs& in) {
  CheckedMesh checked = check_mesh(parse_mesh(in.files.at(0).text(), in.source->mesh));
  for (const std::string& warning : warnings(checked.report)) spdlog::warn("{}: {}", in.item, warning);
  return std::move(checked.mesh);
}

// Picks alone are enough: the saliency is then made from them, as the study's authors did. [chen2012]
Value load_ground_truth(const StageInputs& in) {
  const Mesh& mesh = in.get<Mesh>(0);
  std::vector<std::string_view> texts;
  for (const SourceData& file : in.files) texts.push_back(file.text());
  GroundTruth truth = parse_ground_truth(*in.source, texts, mesh.vertices.size());
  if (truth.saliency.empty() && truth.picks.empty())
    throw InputError(
        fmt::format("{}: nobody picked a point and there is no saliency file; remove the empty .pid files",
                    in.source->picks.front().string()));
  if (truth.saliency.empty()) truth.saliency = smoothed_picks(mesh, truth.picks);
  return truth;
}

std::span<const Vec3> points_of(const Value& shape) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->vertices;
  return std::get<Scan>(shape).points;
}

std::span<const Triangle> faces_of(const Value& surface) {
  if (const auto* mesh = std::get_if<Mesh>(&surface)) return mesh->faces;
  return std::get<Faces>(surface);
}

// --- building a chain ----------------------------------------------------------------------------------

class ChainBuilder {
 public:
  ChainBuilder(Chain& chain, const Chain* of_mesh) : chain_(chain), of_mesh_(of_mesh) {}

  Input shape(std::string_view stage) const { return {Input::From::shape, stage_index(chain_, stage)}; }
  Input mesh(std::string_view stage) const { return {Input::From::mesh, stage_index(*of_mesh_, stage)}; }
  static Input reference() { return {Input::From::reference, 0}; }

  void add(Stage stage) {
    for (const Input& input : stage.inputs)
      stage.after_reference |= input.from == Input::From::reference ||
                               (input.from == Input::From::shape && chain_[input.stage].after_reference);
    chain_.push_back(std::move(stage));
  }

 private:
  Chain& chain_;
  const Chain* of_mesh_;
};

// Names of the stages that play the same part for meshes and for scans.
struct Parts {
  std::string_view points, normals, surface, ground_truth;
};
constexpr Parts kMeshParts{"mesh", "normals", "mesh", "ground_truth"};
constexpr Parts kScanParts{"scan", "scan_normals", "surface", "scan_ground_truth"};

// A map from outside in place of a computed one. The points are read for their number alone.
void add_given_map(ChainBuilder& chain, const Parts& parts, const Model& model, std::string stage) {
  chain.add({.name = std::move(stage),
             .version = model.version,
             .kind = "field",
             .inputs = {chain.shape(parts.points)},
             .source = Source::map_file,
             .run = [maps = model.given](const StageInputs& in) -> Value {
               return maps->checked(in.files.at(0), in.item, points_of(*in.values[0]).size());
             }});
}

void add_map(ChainBuilder& chain, const Parts& parts, const Model& model, std::string stage) {
  std::vector<Input> inputs = {chain.shape(parts.points)};
  if ((model.reads & kReadsNormals) != 0) inputs.push_back(chain.shape(parts.normals));
  if ((model.reads & kReadsFaces) != 0) inputs.push_back(chain.shape(parts.surface));
  if ((model.reads & kReadsFpfh) != 0) inputs.push_back(chain.shape("fpfh"));
  chain.add({.name = std::move(stage),
             .version = model.version,
             .kind = "field",
             .options = {{"models." + model.name, model.options}},
             .inputs = std::move(inputs),
             .seeded = (model.reads & kReadsSeed) != 0,
             .run = [model](const StageInputs& in) -> Value {
               std::size_t next = 1;
               ModelInput input{.points = points_of(*in.values[0]), .seed = in.seed, .item = in.item};
               if ((model.reads & kReadsNormals) != 0) input.normals = in.get<Normals>(next++);
               if ((model.reads & kReadsFaces) != 0) input.faces = faces_of(*in.values[next++]);
               if ((model.reads & kReadsFpfh) != 0) input.fpfh = &in.get<Descriptors>(next++);
               return model.saliency(input);
             }});
}

void add_model(ChainBuilder& chain, const Parts& parts, const Config& config, const Model& model) {
  const std::string map = "map." + model.name, matched_map = "matched." + model.name;
  if (model.given && model.given->matched) {
    add_given_map(chain, parts, model, matched_map);
  } else {
    if (model.given)
      add_given_map(chain, parts, model, map);
    else
      add_map(chain, parts, model, map);
    chain.add({.name = matched_map,
               .version = 1,
               .kind = "field",
               .inputs = {chain.shape(map), ChainBuilder::reference()},
               .run = [](const StageInputs& in) -> Value {
                 return matched(in.get<ScalarField>(0), in.get<Histogram>(1));
               }});
  }
  chain.add({.name = "scores." + model.name,
             .version = scores_version(),
             .kind = "scores",
             .options = {{"metrics", options_text(config.metrics)}},
             .inputs = {chain.shape(matched_map), chain.shape(parts.ground_truth)},
             .seeded = true,
             .run = [options = config.metrics, name = model.name](const StageInputs& in) -> Value {
               return score(in.get<ScalarField>(0), in.get<GroundTruth>(1), options,
                            Rng(in.seed, "scores." + name, in.item));
             }});
}

// A group's map is matched like a model's, and so is the map of the others, which stands for the ground
// truth.
GroupScorer group_scorer(const Histogram& reference, const MetricsOptions& options, const Rng& rng) {
  return {
      metric_table().size(), [=](const ScalarField& map, const GroundTruth& others) {
        const GroundTruth matched_others{matched(others.saliency, reference), others.picks, others.simulated};
        return score(matched(map, reference), matched_others, options, rng);
      }};
}

std::function<bool(const DatasetItem&)> has_participants(const Config& config) {
  if (!config.simulated())
    return [](const DatasetItem& item) { return item.picks.size() >= kFewestParticipants; };
  const bool enough = static_cast<std::size_t>(config.simulation.participants) >= kFewestParticipants;
  return [enough](const DatasetItem&) { return enough; };
}

// HS has no map: its scores come from the participants, who saw meshes only.
void add_people(ChainBuilder& chain, const Config& config, const Model& model) {
  const std::string scores = "scores." + model.name, curve = "curve." + model.name;
  const std::vector<Input> inputs = {chain.shape("mesh"), chain.shape("ground_truth"),
                                     ChainBuilder::reference()};
  const std::int32_t version = model.version + scores_version() - 1;  // grows with either
  const auto scorer = [options = config.metrics, scores](const StageInputs& in) {
    return group_scorer(in.get<Histogram>(2), options, Rng(in.seed, scores, in.item));
  };
  chain.add({.name = scores,
             .version = version,
             .kind = "scores",
             .options = {{"metrics", options_text(config.metrics)}},
             .inputs = inputs,
             .seeded = true,
             .applies = has_participants(config),
             .run = [scorer](const StageInputs& in) -> Value {
               return one_against_rest(in.get<Mesh>(0), in.get<GroundTruth>(1), scorer(in));
             }});
  chain.add({.name = curve,
             .version = version,
             .kind = "human_curve",
             .options = {{"models." + model.name, model.options}, {"metrics", options_text(config.metrics)}},
             .inputs = inputs,
             .seeded = true,
             .applies = has_participants(config),
             .run = [scorer, curve, people = model.people](const StageInputs& in) -> Value {
               return people(in.get<Mesh>(0), in.get<GroundTruth>(1), scorer(in),
                             Rng(in.seed, curve, in.item));
             }});
}

// Rows that meshes and scans share: descriptors, models, scores.
void add_evaluation(ChainBuilder& chain, const Parts& parts, const Config& config) {
  chain.add({.name = "fpfh",
             .version = 1,
             .kind = "descriptors",
             .options = {{"fpfh", options_text(config.fpfh)}},
             .inputs = {chain.shape(parts.points), chain.shape(parts.normals)},
             .run = [options = config.fpfh](const StageInputs& in) -> Value {
               return fpfh(points_of(*in.values[0]), in.get<Normals>(1), options);
             }});
  for (const Model& model : config.models)
    if (model.is_map()) add_model(chain, parts, config, model);
}

Stage mesh_ground_truth(const ChainBuilder& chain, const Config& config) {
  if (config.simulated())
    return {.name = "ground_truth",
            .version = 1,
            .kind = "ground_truth",
            .options = {{"simulation", options_text(config.simulation)}},
            .inputs = {chain.shape("mesh")},
            .seeded = true,
            .run = [options = config.simulation](const StageInputs& in) -> Value {
              return simulated_ground_truth(in.get<Mesh>(0), options, in.seed, in.item);
            }};
  return {.name = "ground_truth",
          .version = 1,
          .kind = "ground_truth",
          .inputs = {chain.shape("mesh")},
          .source = Source::truth_files,
          .run = load_ground_truth};
}

Chain mesh_chain(const Config& config) {
  Chain stages;
  ChainBuilder chain(stages, nullptr);
  chain.add({.name = "mesh", .version = 1, .kind = "mesh", .source = Source::mesh_file, .run = load_mesh});
  chain.add(mesh_ground_truth(chain, config));
  if (!config.dataset.meshes) return stages;  // only what scans read
  chain.add({.name = "normals",
             .version = 1,
             .kind = "normals",
             .options = {{"normals", options_text(config.normals)}},
             .inputs = {chain.shape("mesh")},
             .run = [options = config.normals](const StageInputs& in) -> Value {
               return mesh_normals(in.get<Mesh>(0), options);
             }});
  add_evaluation(chain, kMeshParts, config);
  for (const Model& model : config.models)
    if (!model.is_map()) add_people(chain, config, model);
  return stages;
}

Chain scan_chain(const Config& config, const Chain& of_mesh) {
  Chain stages;
  if (!config.dataset.scans) return stages;
  ChainBuilder chain(stages, &of_mesh);
  chain.add({.name = "scan",
             .version = 1,
             .kind = "scan",
             .options = {{"scan", options_text(config.scan)}},
             .inputs = {chain.mesh("mesh")},
             .per_view = true,
             .run = [options = config.scan](const StageInputs& in) -> Value {
               return simulate_scan(in.get<Mesh>(0), in.view, options);
             }});
  chain.add({.name = "scan_ground_truth",
             .version = 1,
             .kind = "ground_truth",
             .inputs = {chain.shape("scan"), chain.mesh("mesh"), chain.mesh("ground_truth")},
             .run = [](const StageInputs& in) -> Value {
               return scan_ground_truth(in.get<Scan>(0), in.get<Mesh>(1), in.get<GroundTruth>(2));
             }});
  chain.add({.name = "scan_normals",
             .version = 1,
             .kind = "normals",
             .options = {{"scan_normals", options_text(config.scan_normals)}},
             .inputs = {chain.shape("scan")},
             .run = [options = config.scan_normals](const StageInputs& in) -> Value {
               return scan_normals(in.get<Scan>(0), options);
             }});
  chain.add({.name = "surface",
             .version = 1,
             .kind = "faces",
             .options = {{"surface", options_text(config.surface)}},
             .inputs = {chain.shape("scan"), chain.shape("scan_normals")},
             .run = [options = config.surface](const StageInputs& in) -> Value {
               return partial_mesh(in.get<Scan>(0), in.get<Normals>(1), options);
             }});
  add_evaluation(chain, kScanParts, config);
  return stages;
}

}  // namespace

Catalog make_catalog(const Config& config) {
  Catalog catalog;
  catalog.mesh = mesh_chain(config);
  catalog.scan = scan_chain(config, catalog.mesh);
  catalog.means.push_back(
      {"reference", 1, std::string(kMeshParts.ground_truth), std::string(kScanParts.ground_truth)});
  for (const Model& model : config.models)
    if (model.is_map() && !(model.given && model.given->matched))
      catalog.means.push_back({"mean_histogram." + model.name, 1, "map." + model.name, "map." + model.name});
  return catalog;
}

Histogram histogram_of(const Value& value) {
  if (const auto* truth = std::get_if<GroundTruth>(&value)) return normalised_histogram(truth->saliency);
  return normalised_histogram(std::get<ScalarField>(value));
}

std::string option_path(const Stage& stage, std::string_view key) {
  const std::string line = fmt::format("\n{}: ", key);
  for (const OptionLines& options : stage.options)
    if (("\n" + options.text).find(line) != std::string::npos)
      return fmt::format("{}.{}", options.section, key);
  return std::string(key);
}

bool has_stage(const Chain& chain, std::string_view name) {
  for (const Stage& stage : chain)
    if (stage.name == name) return true;
  return false;
}

std::size_t stage_index(const Chain& chain, std::string_view name) {
  for (std::size_t i = 0; i < chain.size(); ++i)
    if (chain[i].name == name) return i;
  throw std::out_of_range(fmt::format("no stage '{}'", name));
}

}  // namespace salbench
