// SPDX-License-Identifier: GPL-3.0-or-later
// A small data set in the Schelling layout on disk, from analytic shapes, and the parts of a run over it.
#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/dataset.h"
#include "pipeline/config/section.h"
#include "pipeline/engine/run.h"
#include "pipeline/inputs/listing.h"
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

// Writes Distributions/NAME.val and RawData/NAME_k.pid below `root`, and returns their contents.
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

// Also writes Meshes/NAME.off.
inline void write_toy_item(const std::filesystem::path& root, const std::string& name, const Mesh& mesh) {
  write_toy_truth(root, name, mesh);
  write_file(root / "Meshes" / (name + ".off"), off_text(mesh));
}

// The meshes "1" and "2", as in most tests.
inline void write_two_toy_items(const std::filesystem::path& root) {
  write_toy_item(root, "1", shapes::bumpy_sphere(2));
  write_toy_item(root, "2", shapes::bumpy_sphere(2, 0.35));
}

// Coarse scans keep tests fast; everything else is as in a real run.
inline constexpr const char* kToyConfig = "scan: {step_degrees: 1}\nmodels: {PS: , RS: }\n";

inline Config toy_config(const std::string& yaml = kToyConfig) {
  return read_config(Section::from_text(yaml, "toy.yaml"), "toy");
}

inline Unit mesh_unit(std::size_t family) { return {kMeshes, static_cast<std::uint32_t>(family)}; }
inline Unit scan_unit(std::size_t family, int view) {
  return {kScans, static_cast<std::uint32_t>(family * kViews + static_cast<std::size_t>(view))};
}

inline std::size_t find_rule(const Rules& rules, Level over, std::string_view stage) {
  for (std::size_t rule = 0; rule < rules.size(); ++rule)
    if (rules[rule].over == over && rules[rule].stage == stage) return rule;
  throw std::out_of_range(fmt::format("there is no rule for stage '{}' of {}", stage, shapes_name(over)));
}

inline bool has_rule(const Rules& rules, Level over, std::string_view stage) {
  return std::ranges::any_of(rules,
                             [&](const Rule& rule) { return rule.over == over && rule.stage == stage; });
}

// Front of the tests in test_pipeline: Python in this process, with its layouts.
const Front& front_of_tests();

// A planned and executed run. The caller owns the store, so that runs can follow each other.
struct ToyRun {
  ToyRun(const std::filesystem::path& root, Store& the_store, const std::string& yaml = kToyConfig,
         const std::string& items = "")
      : ToyRun(root, the_store, toy_config(yaml), items) {}

  ToyRun(const std::filesystem::path& root, Store& the_store, Config the_config,
         const std::string& items = "")
      : config(std::move(the_config)),
        inputs(read_inputs(find_dataset(root, config.dataset.layout, front_of_tests()), items, {},
                           config.dataset.split)),
        project(make_project(config, inputs, {}, front_of_tests())),
        store(the_store) {
    make_plan_again();
  }
  ToyRun(const ToyRun&) = delete;
  ToyRun& operator=(const ToyRun&) = delete;

  void make_plan_again() { resolver = std::make_unique<Resolver>(project, make_plan(project, store), store); }
  void run(int threads = 2) { run_jobs(*resolver, {.threads = threads}, progress, stop); }
  RunState state() { return {config, inputs, *resolver}; }
  std::vector<ResultRow> results() { return collect_results(state()); }
  const Plan& plan() const { return resolver->plan(); }
  template <class T>
  T value(std::string_view stage, Unit unit) const {
    return value_as<T>(*resolver->value({index(stage, unit.level), unit}));
  }

  std::size_t index(std::string_view stage, Level level = kMeshes) const {
    return find_rule(project.rules, level, stage);
  }
  Rule& rule(std::string_view stage, Level level = kMeshes) { return project.rules[index(stage, level)]; }
  const Decision& decision(std::string_view stage, std::size_t family) const {  // for a mesh
    return plan()[{index(stage), mesh_unit(family)}];
  }
  std::size_t count(State state, bool computed = false) const {  // over shapes, without the data set
    std::size_t n = 0;
    for (const Job& job : project.jobs())
      n += job.unit.level != kRoot && plan()[job].state == state && plan()[job].computed() == computed ? 1U
                                                                                                       : 0U;
    return n;
  }
  std::size_t open() const { return count(State::open); }

  Config config;
  Inputs inputs;
  Project project;
  Store& store;
  std::unique_ptr<Resolver> resolver;
  NoProgress progress;
  std::atomic<bool> stop = false;
};

}  // namespace salbench
