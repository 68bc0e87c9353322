#include "pipeline/export.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "cache/artefact_name.h"
#include "io/file.h"
#include "io/shape_file.h"
#include "pipeline/export_file.h"
#include "pipeline/interrupt.h"
#include "pipeline/option_text.h"
#include "pipeline/results.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> stages_of(const Catalog& catalog) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Chain* chain : {&catalog.mesh, &catalog.scan})
    for (const Stage& stage : *chain) add(stage.name);
  for (const MeanHistogram& mean : catalog.means) add(mean.name);
  return names;
}

// "map" names "map.LS" and all its like.
StageNames selected_stages(const std::string& list, const Catalog& catalog) {
  const std::vector<std::string> known = stages_of(catalog);
  const std::vector<std::string> wanted = split_list(list);
  if (wanted.empty()) return {known.begin(), known.end()};
  StageNames selected;
  for (const std::string& part : wanted) {
    bool found = false;
    for (const std::string& stage : known) {
      if (stage != part && !stage.starts_with(part + ".")) continue;
      selected.insert(stage);
      found = true;
    }
    if (!found)
      throw ConfigError(fmt::format("--stage {}: there is no stage '{}'; there are {}", list, part,
                                    fmt::join(known, ", ")));
  }
  return selected;
}

// --- shapes -----------------------------------------------------------------------------------------------

// Gives a shape the part of it that a stage's value holds. The value must outlive the shape.
struct Addition {
  ShapeWithFields& shape;
  const std::string& stage;

  void operator()(const Mesh& mesh) const {
    shape.points = mesh.vertices;
    shape.faces = mesh.faces;
  }
  void operator()(const Scan& scan) const { shape.points = scan.points; }
  void operator()(const Normals& normals) const { shape.normals = normals; }
  void operator()(const Faces& faces) const { shape.faces = faces; }
  void operator()(const ScalarField& field) const { shape.fields.push_back({item_label(stage), field}); }
  void operator()(const GroundTruth& truth) const {
    if (!truth.saliency.empty()) shape.fields.push_back({"ground_truth", truth.saliency});
    ScalarField picks(shape.points.size());
    for (const auto& participant : truth.picks)
      for (const std::int32_t point : participant) ++picks[static_cast<std::size_t>(point)];
    shape.fields.push_back({"picks", std::move(picks)});
  }
  template <class Other>
  void operator()(const Other&) const {}  // not per point
};

bool is_points(const Stage& stage) { return stage.kind == "mesh" || stage.kind == "scan"; }

// Stages stand in the order of their inputs: the points come first.
bool write_shape(Session& session, const ItemRef& item, ShapeFormat format, const StageNames& stages,
                 const fs::path& folder) {
  const Context& context = session.setup.context;
  const Chain& chain = context.chain(item);
  ShapeWithFields shape;
  if (session.setup.config.simulated()) shape.remark = kSimulatedNote;
  std::vector<Value> values;
  values.reserve(chain.size());  // spans refer to them
  for (std::size_t s = 0; s < chain.size(); ++s) {
    if (!session.plan.jobs(item)[s].known()) continue;
    if (!is_points(chain[s]) && !stages.contains(chain[s].name)) continue;
    values.push_back(session.runner.result(item, s));
    std::visit(Addition{shape, chain[s].name}, values.back());
  }
  if (shape.points.empty()) return false;
  write_file(folder / fmt::format("{}.{}", context.name(item), name_of(format)), shape_text(shape, format));
  return true;
}

std::size_t write_shapes(Session& session, ShapeFormat format, const StageNames& stages,
                         const fs::path& folder, const std::atomic<bool>& stop) {
  make_folder(folder, "choose another with --to");
  const std::vector<ItemRef> items = session.setup.context.items();
  std::size_t written = 0;
  session.progress->begin("exporting", items.size());
  for (const ItemRef& item : items) {
    if (stop) break;
    written += write_shape(session, item, format, stages, folder) ? 1U : 0U;
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

}  // namespace

ExitStatus export_command(const Arguments& arguments, const ExportOptions& options,
                          const std::atomic<bool>& stop) {
  ShapeFormat format{};
  const bool shapes = options.format != "h5";
  if (shapes && !parse_option(options.format, format))
    throw ConfigError(
        fmt::format("--format {}: must be h5 or {}", options.format, expected_of<ShapeFormat>()));
  if (shapes && options.link) throw ConfigError("--link: only one HDF5 file (--format h5) can hold links");

  Session session(arguments, stop);
  const StageNames stages = selected_stages(options.stages, session.setup.catalog);
  const OrderlyEnd orderly;
  session.runner.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);

  std::string done = fmt::format("exported to {}\n", arguments.to);
  if (shapes) {
    const std::size_t written = write_shapes(session, format, stages, arguments.to, stop);
    if (stop) return interrupted_status(arguments);
    done = fmt::format("{} shapes written to {}\n", written, arguments.to);
  } else if (!export_file(session, stages, arguments.to, options.link, stop)) {
    return interrupted_status(arguments);
  }
  if (!arguments.quiet) fmt::print("{}", done);
  return finished_status(session);
}

}  // namespace salbench
