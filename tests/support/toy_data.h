// SPDX-License-Identifier: GPL-3.0-or-later
// A small data set in the Schelling layout on disk, made from analytic shapes, and the pieces of a run over
// it.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "io/dataset.h"
#include "io/file.h"
#include "pipeline/config/section.h"
#include "pipeline/results/results.h"
#include "stages/ground_truth/simulation.h"
#include "tests/support/shapes.h"

namespace salbench {

inline std::string off_text(const Mesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.faces.size());
  for (const Vec3& v : mesh.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const Triangle& f : mesh.faces) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
  return text;
}

// Writes Distributions/NAME.val and RawData/NAME_k.pid below `root`, and returns what they say.
inline GroundTruth write_toy_truth(const std::filesystem::path& root, const std::string& name,
                                   const Mesh& mesh) {
  const GroundTruth truth = simulated_ground_truth(mesh, {.participants = 4, .picks = 5}, 1, name);
  for (const char* folder : {"Meshes", "Distributions", "RawData"})
    std::filesystem::create_directories(root / folder);
  std::string values;
  for (const double v : truth.saliency) values += fmt::format("{}\n", v);
  write_file(root / "Distributions" / (name + ".val"), values);
  for (std::size_t k = 0; k < truth.picks.size(); ++k) {
    std::string picks;
    for (const std::int32_t i : truth.picks[k]) picks += fmt::format("{}\n", i);
    write_file(root / "RawData" / fmt::format("{}_{}.pid", name, k), picks);
  }
  return truth;
}

// The same, and Meshes/NAME.off.
inline void write_toy_item(const std::filesystem::path& root, const std::string& name, const Mesh& mesh) {
  write_toy_truth(root, name, mesh);
  write_file(root / "Meshes" / (name + ".off"), off_text(mesh));
}

// Coarse scans keep tests quick; everything else is as in a real run.
inline constexpr const char* kToyConfig = "scan: {step_degrees: 1}\nmodels: {PS: , RS: }\n";

inline Config toy_config(const std::string& yaml = kToyConfig) {
  return read_config(Section::from_text(yaml, "toy.yaml"), "toy");
}

// One planned and executed run. The store is the caller's, so that runs can follow each other.
struct ToyRun {
  ToyRun(const std::filesystem::path& root, Store& the_store, const std::string& yaml = kToyConfig,
         const std::string& items = "")
      : ToyRun(root, the_store, toy_config(yaml), items) {}

  ToyRun(const std::filesystem::path& root, Store& the_store, Config the_config,
         const std::string& items = "")
      : config(std::move(the_config)),
        workload(make_workload(find_dataset(root, layouts_of(config.dataset.layout), config.dataset.twins),
                               items)),
        catalog(make_catalog(config, {}, kinds_of(workload))),
        context{catalog, workload, config.seed},
        store(the_store),
        plan(make_plan(context, store)),
        progress(std::make_unique<NoProgress>()),
        runner(context, plan, store, *progress, stop) {}
  ToyRun(const ToyRun&) = delete;
  ToyRun& operator=(const ToyRun&) = delete;

  void run(int threads = 2) { runner.run(threads); }
  RunState state() { return {config, context, plan, runner}; }
  std::vector<ResultRow> results() { return collect_results(state()); }
  std::size_t row(std::string_view name, Shapes shapes = Shapes::meshes) const {
    return catalog.index(shapes, name);
  }
  Job& mesh_job(std::string_view name, std::size_t family) { return plan[{row(name), Item::mesh(family)}]; }
  std::size_t count(Verdict verdict) const {  // of shapes, not of the data set
    std::size_t n = 0;
    for (const Item& item : all_items(context))
      for (const JobRef& job : jobs_of(catalog, item)) n += plan[job].verdict == verdict ? 1U : 0U;
    return n;
  }
  std::size_t open() const { return count(Verdict::wait) + count(Verdict::compute); }

  Config config;
  Workload workload;
  Catalog catalog;
  Context context;
  Store& store;
  Plan plan;
  std::unique_ptr<Progress> progress;
  std::atomic<bool> stop = false;
  Runner runner;
};

}  // namespace salbench
