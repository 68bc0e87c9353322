#include "pipeline/export_file.h"

#include <utility>

#include <fmt/format.h>

#include "pipeline/results.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScores = "scores", kMeans = "means";

// Where a result comes from: the attributes have the names that they have in the artefact.
struct Origin {
  Recipe recipe;
  std::string_view kind;
  const Job& job;
};

std::optional<Digest> nowhere(std::string_view, const Digest&) { return {}; }  // to have a recipe spelt out

Attributes attributes_of(const Origin& origin) {
  std::string inputs;
  for (const auto& [name, content] : origin.recipe.inputs)
    inputs += fmt::format("{}: {}\n", name, content.hex());
  return {{"stage", origin.recipe.stage},     {"stage_version", std::int64_t{origin.recipe.stage_version}},
          {"kind", std::string(origin.kind)}, {"options", origin.recipe.options},
          {"seed", origin.recipe.seed},       {"inputs", std::move(inputs)},
          {"key", origin.job.key.hex()},      {"content", origin.job.content.hex()}};
}

class Exporter {
 public:
  Exporter(Session& session, const StageNames& stages, const std::optional<fs::path>& links_from)
      : session_(session), context_(session.setup.context), stages_(stages), links_from_(links_from) {}

  Hdf5Content content() && {
    check_names();
    add_root();
    for (std::size_t f = 0; f < context_.workload.families.size(); ++f)
      for (const ItemRef& item : context_.family(f)) add_item(item);
    for (std::size_t mean = 0; mean < context_.catalog.means.size(); ++mean)
      for (const bool meshes : {true, false}) add_mean(mean, meshes);
    add_scores();
    return std::move(content_);
  }

 private:
  // A mesh file may be called "52_3", as the scan 3 of the mesh 52 is.
  void check_names() const {
    std::set<std::string, std::less<>> names = {std::string(kScores), std::string(kMeans)};
    for (std::size_t f = 0; f < context_.workload.families.size(); ++f)
      for (const ItemRef& item : context_.family(f))
        if (!names.insert(context_.name(item)).second)
          throw ConfigError(fmt::format(
              "two things of the export would be called '{}': rename the mesh, or leave it out with --items",
              context_.name(item)));
  }

  void add_root() {
    const Config& config = session_.setup.config;
    std::string versions;
    for (const Chain* chain : {&context_.catalog.mesh, &context_.catalog.scan})
      for (const Stage& stage : *chain)
        if (chain == &context_.catalog.mesh || !has_stage(context_.catalog.mesh, stage.name))
          versions += fmt::format("{}: {}\n", stage.name, stage.version);
    content_.attributes = {
        {"program", fmt::format("salbench {}", SALBENCH_VERSION)},
        {"layout", std::string("salbench export 1")},
        {"configuration", config_yaml(config)},
        {"stage_versions", std::move(versions)},
        {"reference", std::string(context_.given_reference ? "given by --reference"
                                                           : "mean over the items of the export")}};
    content_.attributes.insert(content_.attributes.end(), context_.attributes.begin(),
                               context_.attributes.end());
  }

  void add_item(const ItemRef& item) {
    const Chain& chain = context_.chain(item);
    const std::string name = context_.name(item);
    Attributes attributes = {{"dataset", std::string(item.is_mesh() ? "meshes" : "scans")},
                             {"item", context_.source(item).name},
                             {"class", context_.source(item).category}};
    if (!item.is_mesh()) attributes.emplace_back("view", std::int64_t{item.view});
    content_.attributes_of.push_back({name, std::move(attributes)});
    for (std::size_t s = 0; s < chain.size(); ++s) {
      const Job& job = session_.plan.jobs(item)[s];
      if (!job.known() || !stages_.contains(chain[s].name)) continue;
      const Origin origin{decide(context_, session_.plan, item, s, nowhere).recipe, chain[s].kind, job};
      const Value value = session_.runner.result(item, s);  // mends a damaged artefact, too
      if (const auto* scores = std::get_if<Scores>(&value))
        add_score(item, origin, *scores);
      else
        add_result(name + "/" + chain[s].name, origin, value);
    }
  }

  void add_result(const std::string& group, const Origin& origin, const Value& value) {
    if (links_from_) {
      const fs::path artefact = session_.store.path(origin.recipe.stage, origin.job.key).value();
      content_.links.push_back({group, fs::relative(artefact, *links_from_).string(), "/"});
    } else {
      add_arrays(group, value);
      content_.attributes_of.push_back({group, attributes_of(origin)});
    }
  }

  void add_arrays(const std::string& group, const Value& value) {
    for (Array& array : arrays_from(value)) {
      array.name = group + "/" + array.name;
      content_.arrays.push_back(std::move(array));
    }
  }

  // A reference that was given is no artefact.
  void add_mean(std::size_t index, bool meshes) {
    const MeanHistogram& mean = context_.catalog.means[index];
    const std::optional<Histogram> histogram = session_.runner.mean(index, meshes);
    if (!histogram || !stages_.contains(mean.name)) return;
    const std::string group = fmt::format("{}/{}/{}", kMeans, mean.name, meshes ? "meshes" : "scans");
    if (index == kReference && context_.given_reference)
      add_arrays(group, *histogram);
    else
      add_result(group,
                 {decide_mean(context_, session_.plan, index, meshes, nowhere).recipe, kind_of(*histogram),
                  session_.plan.means[index][meshes ? 0 : 1]},
                 *histogram);
  }

  void add_score(const ItemRef& item, const Origin& origin, const Scores& scores) {
    const std::string& stage = origin.recipe.stage;
    rows_.push_back({item.is_mesh() ? "meshes" : "scans", context_.source(item).name,
                     context_.source(item).category, item.is_mesh() ? "" : std::to_string(item.view),
                     stage.substr(stage.find('.') + 1), scores});
    origins_.emplace_back(origin.job.key, origin.job.content);
  }

  void add_scores() {
    if (rows_.empty()) return;
    Table table = results_table(rows_);
    table.columns.insert(table.columns.end(), {"key", "content"});
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      table.rows[r].insert(table.rows[r].end(), {origins_[r].first.hex(), origins_[r].second.hex()});
    content_.tables.push_back({std::string(kScores), std::move(table),
                               "agreement of each model's map with the ground truth; NaN where undefined"});
  }

  Session& session_;
  const Context& context_;
  const StageNames& stages_;
  const std::optional<fs::path>& links_from_;
  Hdf5Content content_;
  std::vector<ResultRow> rows_;
  std::vector<std::pair<Digest, Digest>> origins_;  // key and content, as rows_
};

}  // namespace

Hdf5Content export_content(Session& session, const StageNames& stages,
                           const std::optional<fs::path>& links_from) {
  return Exporter(session, stages, links_from).content();
}

}  // namespace salbench
