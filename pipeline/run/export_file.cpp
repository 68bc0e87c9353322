// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/export_file.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5/hdf5_writer.h"
#include "pipeline/results/counts.h"
#include "pipeline/results/tables.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScores = "scores", kMeans = "means";

class Exporter {
 public:
  Exporter(Session& session, const StageNames& stages, const fs::path& folder, bool link)
      : session_(session),
        run_(session.state()),
        project_(run_.project()),
        stages_(stages),
        folder_(folder),
        link_(link) {
    require_distinct_names(run_, {std::string(kScores), std::string(kMeans)});
  }

  void write(const fs::path& target) {
    UnfinishedFile unfinished(folder_);
    file_.emplace(unfinished.path());
    add_root();
    const std::vector<Unit> shapes = run_.shapes();
    session_.progress->begin("exporting", shapes.size());
    for (const Unit shape : shapes) {
      if (session_.stop) return;
      add_shape(shape);
      session_.progress->item_done();
    }
    session_.progress->end();
    for (const Job& mean : project_.jobs_of(Unit{}))
      add_result(fmt::format("{}/{}/{}", kMeans, project_.rule(mean).stage, project_.name(mean)), mean);
    add_scores();
    file_->close();
    unfinished.finish(target);
  }

 private:
  void add_root() {
    std::string versions;
    for (const std::vector<std::size_t>& of_stage : rules_by_stage(project_.rules))
      versions +=
          fmt::format("{}: {}\n", project_.rules[of_stage[0]].stage, project_.rules[of_stage[0]].version);
    Attributes attributes = {{"program", fmt::format("salbench {}", SALBENCH_VERSION)},
                             {"layout", std::string("salbench export 1")},
                             {"configuration", config_yaml(run_.config)},
                             {"stage_versions", std::move(versions)},
                             {"reference", reference_text(run_, "export")}};
    attributes.insert(attributes.end(), project_.attributes.begin(), project_.attributes.end());
    file_->attributes("/", attributes);
  }

  void add_shape(Unit shape) {
    const std::string name = project_.units.name(shape);
    const Item& item = item_of(project_.units, shape);
    Attributes attributes = {{"dataset", std::string(shapes_name(shape.level))},
                             {"item", item.shape_name()},
                             {"class", item.category}};
    if (!item.view.empty()) attributes.emplace_back("truth_view", item.view);
    if (!item.split.empty()) attributes.emplace_back("split", item.split);
    if (shape.level == kScans) attributes.emplace_back("view", std::int64_t{project_.units.place(shape)});
    file_->attributes(name, attributes);
    for (const Job& job : project_.jobs_of(shape))
      if (!has_role(project_.rule(job), Role::scores)) add_result(name + "/" + project_.rule(job).stage, job);
  }

  bool requested(const Job& job) const {
    return run_.decision(job).known() && stages_.contains(project_.rule(job).stage);
  }

  // Given results have no artefact: their arrays are written without attributes.
  void add_result(const std::string& group, const Job& job) {
    if (!requested(job)) return;
    const Rule& rule = project_.rule(job);
    if (rule.given) {
      for (Array& array : rule.arrays(*rule.given)) {
        array.name = group + "/" + array.name;
        file_->array(array);
      }
      return;
    }
    const Artefact artefact = artefact_of(job);
    const auto place = link_ ? session_.store.location(artefact.key) : std::nullopt;
    if (link_ && !place) throw_removed();
    for (const PackedArray& array : artefact.arrays) {
      const std::string name = group + "/" + array.name;
      if (place)
        file_->link({name, fs::relative(place->file, folder_).string(), place->group + "/" + array.name});
      else
        file_->array({name, array});
    }
    file_->attributes(group, link_ ? attributes_of(artefact) : lasting_attributes_of(artefact));
  }

  // Reading the result restores a damaged artefact.
  Artefact artefact_of(const Job& job) {
    const Digest& key = run_.decision(job).key;
    std::optional<Artefact> artefact = session_.store.artefact(key);
    if (!artefact) {
      run_.resolver.value(job);
      artefact = session_.store.artefact(key);
    }
    if (!artefact) throw_removed();
    return std::move(*artefact);
  }

  [[noreturn]] void throw_removed() const {
    throw StorageError(fmt::format("{}: something removes its artefacts while they are exported; run again",
                                   session_.setup.cache.string()));
  }

  void add_scores() {
    std::vector<ResultRow> rows = collect_results(run_);
    std::erase_if(rows, [&](const ResultRow& row) { return !requested(row.job); });
    if (rows.empty()) return;
    Table table = results_table(rows, chosen_metrics(run_.config.metrics));
    table.columns.insert(table.columns.end(), {"key", "content"});
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Decision& decision = run_.decision(rows[r].job);
      table.rows[r].insert(table.rows[r].end(), {decision.key.hex(), decision.content.hex()});
    }
    file_->table({std::string(kScores), std::move(table),
                  "agreement of each model's map with the ground truth; NaN where undefined"});
  }

  Session& session_;
  const RunState run_;
  const Project& project_;
  const StageNames& stages_;
  const fs::path& folder_;
  bool link_;
  std::optional<Hdf5Writer> file_;
};

}  // namespace

void require_distinct_names(const RunState& run, StageNames taken) {
  for (const Unit shape : run.shapes())
    if (const std::string name = run.units().name(shape); !taken.insert(name).second)
      throw ConfigError(fmt::format(
          "two things of the export would be called '{}': rename the shape, or leave it out with --items",
          name));
}

void export_file(Session& session, const StageNames& stages, const fs::path& target, bool link) {
  const fs::path folder = fs::absolute(target).parent_path();
  make_folder(folder, "choose another with --to");
  Exporter(session, stages, folder, link).write(target);
}

}  // namespace salbench
