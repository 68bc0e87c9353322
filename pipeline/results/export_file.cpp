// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/export_file.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5_writer.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScores = "scores", kMeans = "means";

// Under the names that they have in the artefact.
Attributes attributes_of(const Recipe& recipe, std::string_view kind, const Job& job) {
  return {{"stage", recipe.stage},     {"stage_version", std::int64_t{recipe.stage_version}},
          {"kind", std::string(kind)}, {"options", recipe.options},
          {"seed", recipe.seed},       {"inputs", inputs_text(recipe)},
          {"key", job.key.hex()},      {"content", job.content.hex()}};
}

class Exporter {
 public:
  Exporter(const ExportSource& source, const StageNames& stages, const fs::path& folder, bool link)
      : source_(source), context_(source.run.context), stages_(stages), folder_(folder), link_(link) {
    check_names();
  }

  bool write(const fs::path& target, const std::atomic<bool>& stop) {
    UnfinishedFile unfinished(folder_);
    file_.emplace(unfinished.path());
    add_root();
    const std::vector<Item> items = all_items(context_);
    Progress& progress = source_.run.runner.progress();
    progress.begin("exporting", items.size());
    for (const Item& item : items) {
      if (stop) return false;
      add_item(item);
      progress.item_done();
    }
    progress.end();
    for (const JobRef& mean : jobs_of(context_.catalog, Item::set()))
      add_result(fmt::format("{}/{}/{}", kMeans, context_.row(mean).name, context_.name(mean)), mean);
    add_scores();
    file_->close();
    unfinished.finish(target);
    return true;
  }

 private:
  // A mesh file may be called "52_3", as the scan 3 of the mesh 52 is.
  void check_names() const {
    std::set<std::string, std::less<>> names = {std::string(kScores), std::string(kMeans)};
    for (const Item& item : all_items(context_))
      if (!names.insert(context_.name(item)).second)
        throw ConfigError(fmt::format(
            "two things of the export would be called '{}': rename the shape, or leave it out with --items",
            context_.name(item)));
  }

  void add_root() {
    std::string versions;
    std::set<std::string> named;
    for (const Row& row : context_.catalog.rows)
      if (!row.gathers && named.insert(row.name).second)
        versions += fmt::format("{}: {}\n", row.name, row.version);
    Attributes attributes = {{"program", fmt::format("salbench {}", SALBENCH_VERSION)},
                             {"layout", std::string("salbench export 1")},
                             {"configuration", config_yaml(source_.run.config)},
                             {"stage_versions", std::move(versions)},
                             {"reference", std::string(context_.catalog.reference_is_given()
                                                           ? "given by --reference"
                                                           : "mean over the items of the export")}};
    attributes.insert(attributes.end(), context_.attributes.begin(), context_.attributes.end());
    file_->attributes("/", attributes);
  }

  void add_item(const Item& item) {
    const std::string name = context_.name(item);
    Attributes attributes = {{"dataset", std::string(name_of(item.shapes()))},
                             {"item", context_.source(item).name},
                             {"class", context_.source(item).category}};
    if (item.is_scan()) attributes.emplace_back("view", std::int64_t{item.view});
    file_->attributes(name, attributes);
    for (const JobRef& job : jobs_of(context_.catalog, item))
      if (context_.row(job).kind != "scores") add_result(name + "/" + context_.row(job).name, job);
  }

  bool wanted(const JobRef& job) const {
    return source_.run.plan[job].known() && stages_.contains(context_.row(job).name);
  }

  // A given result has no artefact: its arrays are written without attributes.
  void add_result(const std::string& group, const JobRef& job) {
    if (!wanted(job)) return;
    const Row& row = context_.row(job);
    if (row.given) {
      for (Array& array : arrays_from(*row.given)) {
        array.name = group + "/" + array.name;
        file_->array(array);
      }
    } else if (const auto [image, path] = artefact_of(job); link_) {
      file_->link({group, fs::relative(path, folder_).string(), "/"});
    } else {
      const Recipe recipe = recipe_of(context_, source_.run.plan, job);
      file_->copy(group, image);
      file_->attributes(group, attributes_of(recipe, row.kind, source_.run.plan[job]));
    }
  }

  // A damaged artefact is made anew by reading its result.
  std::pair<Bytes, fs::path> artefact_of(const JobRef& job) {
    const std::string& stage = context_.row(job).name;
    const Digest& key = source_.run.plan[job].key;
    std::optional<Bytes> image = source_.store.image(stage, key);
    if (!image) {
      source_.run.runner.result(job);
      image = source_.store.image(stage, key);
    }
    const auto path = source_.store.path(stage, key);
    if (!image || !path)
      throw StorageError(fmt::format("{}: something removes its artefacts while they are exported; run again",
                                     source_.cache.string()));
    return {std::move(*image), *path};
  }

  void add_scores() {
    std::vector<ResultRow> rows = collect_results(source_.run);
    std::erase_if(rows, [&](const ResultRow& row) { return !wanted(row.job); });
    if (rows.empty()) return;
    Table table = results_table(rows, chosen_metrics(source_.run.config.metrics));
    table.columns.insert(table.columns.end(), {"key", "content"});
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Job& job = source_.run.plan[rows[r].job];
      table.rows[r].insert(table.rows[r].end(), {job.key.hex(), job.content.hex()});
    }
    file_->table({std::string(kScores), std::move(table),
                  "agreement of each model's map with the ground truth; NaN where undefined"});
  }

  const ExportSource& source_;
  const Context& context_;
  const StageNames& stages_;
  const fs::path& folder_;
  bool link_;
  std::optional<Hdf5Writer> file_;
};

}  // namespace

bool export_file(const ExportSource& source, const StageNames& stages, const fs::path& target, bool link,
                 const std::atomic<bool>& stop) {
  const fs::path folder = fs::absolute(target).parent_path();
  make_folder(folder, "choose another with --to");
  return Exporter(source, stages, folder, link).write(target, stop);
}

}  // namespace salbench
