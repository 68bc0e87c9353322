#include "pipeline/export_file.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5_writer.h"
#include "pipeline/results.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScores = "scores", kMeans = "means";

// Origin of a result; its attributes have the names that they have in the artefact.
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
  Exporter(Session& session, const StageNames& stages, const fs::path& folder, bool link)
      : session_(session), context_(session.setup.context), stages_(stages), folder_(folder), link_(link) {
    check_names();
  }

  bool write(const fs::path& target, const std::atomic<bool>& stop) {
    UnfinishedFile unfinished(folder_);
    file_.emplace(unfinished.path());
    add_root();
    const std::vector<ItemRef> items = context_.items();
    session_.progress->begin("exporting", items.size());
    for (const ItemRef& item : items) {
      if (stop) return false;
      add_item(item);
      session_.progress->item_done();
    }
    session_.progress->end();
    for (std::size_t mean = 0; mean < context_.catalog.means.size(); ++mean)
      for (const bool meshes : {true, false}) add_mean(mean, meshes);
    add_scores();
    file_->close();
    unfinished.finish(target);
    return true;
  }

 private:
  // A mesh file may be called "52_3", as the scan 3 of the mesh 52 is.
  void check_names() const {
    std::set<std::string, std::less<>> names = {std::string(kScores), std::string(kMeans)};
    for (const ItemRef& item : context_.items())
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
    Attributes attributes = {
        {"program", fmt::format("salbench {}", SALBENCH_VERSION)},
        {"layout", std::string("salbench export 1")},
        {"configuration", config_yaml(config)},
        {"stage_versions", std::move(versions)},
        {"reference", std::string(context_.given_reference ? "given by --reference"
                                                           : "mean over the items of the export")}};
    attributes.insert(attributes.end(), context_.attributes.begin(), context_.attributes.end());
    file_->attributes("/", attributes);
  }

  void add_item(const ItemRef& item) {
    const Chain& chain = context_.chain(item);
    const std::string name = context_.name(item);
    Attributes attributes = {{"dataset", std::string(item.is_mesh() ? "meshes" : "scans")},
                             {"item", context_.source(item).name},
                             {"class", context_.source(item).category}};
    if (!item.is_mesh()) attributes.emplace_back("view", std::int64_t{item.view});
    file_->attributes(name, attributes);
    for (std::size_t s = 0; s < chain.size(); ++s) {
      const Job& job = session_.plan.jobs(item)[s];
      if (!job.known() || !stages_.contains(chain[s].name)) continue;
      const Origin origin{decide(context_, session_.plan, item, s, nowhere).recipe, chain[s].kind, job};
      const auto result = [&] { return session_.runner.result(item, s); };
      if (chain[s].kind == "scores")
        add_score(item, origin, std::get<Scores>(result()));
      else
        add_result(name + "/" + chain[s].name, origin, result);
    }
  }

  // `compute` makes a damaged artefact anew.
  template <class Compute>
  void add_result(const std::string& group, const Origin& origin, const Compute& compute) {
    const auto read = [&] { return session_.store.image(origin.recipe.stage, origin.job.key); };
    std::optional<Bytes> image = read();
    if (!image) {
      compute();
      image = read();
    }
    const auto artefact = session_.store.path(origin.recipe.stage, origin.job.key);
    if (!image || !artefact)
      throw StorageError(fmt::format("{}: something removes its artefacts while they are exported; run again",
                                     session_.setup.cache.string()));
    if (link_) {
      file_->link({group, fs::relative(*artefact, folder_).string(), "/"});
    } else {
      file_->copy(group, *image);
      file_->attributes(group, attributes_of(origin));
    }
  }

  // A reference that was given is no artefact.
  void add_mean(std::size_t index, bool meshes) {
    const MeanHistogram& mean = context_.catalog.means[index];
    const std::optional<Histogram> histogram = session_.runner.mean(index, meshes);
    if (!histogram || !stages_.contains(mean.name)) return;
    const std::string group = fmt::format("{}/{}/{}", kMeans, mean.name, meshes ? "meshes" : "scans");
    if (index == kReference && context_.given_reference) {
      for (Array& array : arrays_from(*histogram)) {
        array.name = group + "/" + array.name;
        file_->array(array);
      }
      return;
    }
    const Origin origin{decide_mean(context_, session_.plan, index, meshes, nowhere).recipe,
                        kind_of(*histogram), session_.plan.means[index][meshes ? 0 : 1]};
    const ArtefactNote note{meshes ? "meshes" : "scans", 0, context_.attributes};
    add_result(group, origin,
               [&] { session_.store.save(origin.recipe, origin.kind, arrays_from(*histogram), note); });
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
    file_->table({std::string(kScores), std::move(table),
                  "agreement of each model's map with the ground truth; NaN where undefined"});
  }

  Session& session_;
  const Context& context_;
  const StageNames& stages_;
  const fs::path& folder_;
  bool link_;
  std::optional<Hdf5Writer> file_;
  std::vector<ResultRow> rows_;
  std::vector<std::pair<Digest, Digest>> origins_;  // key and content, as rows_
};

}  // namespace

bool export_file(Session& session, const StageNames& stages, const fs::path& target, bool link,
                 const std::atomic<bool>& stop) {
  const fs::path folder = fs::absolute(target).parent_path();
  make_folder(folder, "choose another with --to");
  return Exporter(session, stages, folder, link).write(target, stop);
}

}  // namespace salbench
