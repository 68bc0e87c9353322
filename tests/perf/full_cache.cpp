// SPDX-License-Identifier: GPL-3.0-or-later
// Fills a cache with every artefact that a run of CONFIG over DATA would leave, without the real
// computations: the program's own engine runs, and only the bodies of the stages are replaced, by made-up
// values of a few bytes. Keys and names are those of a real cache, so that `salbench plan` and a
// rerun with nothing to do can be measured at the size of the whole benchmark. The scores in it mean nothing.
//   perf_full_cache CONFIG DATA CACHE
#include <atomic>
#include <iostream>

#include "pipeline/commands/session.h"
#include "pipeline/engine/run.h"
#include "stages/core/rng.h"
#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

Scores made_up_scores(std::size_t n_metrics, Rng& rng) {
  Scores scores{.values = {}, .n_points = 5000, .n_picks = 60};
  for (std::size_t m = 0; m < n_metrics; ++m) scores.values.push_back(rng.uniform());
  return scores;
}

// A valid value of the kind; fields are told from each other by stage and item.
Value made_up(std::string_view kind, std::size_t n_metrics, Rng rng) {
  const Vec3 point(rng.uniform(), rng.uniform(), rng.uniform());
  const ScalarField field = {rng.uniform(), rng.uniform(), 1};
  if (kind == "mesh") return Mesh{{point, Vec3::Zero(), Vec3::UnitX()}, {{0, 1, 2}}};
  if (kind == "scan") return Scan{{point}, Vec3::UnitZ()};
  if (kind == "normals") return Normals{point.normalized()};
  if (kind == "faces") return Faces{{0, 1, 2}};
  if (kind == "descriptors")
    return Descriptors{std::vector<float>(kFpfhBins, static_cast<float>(point.x())), 1, 0};
  if (kind == "field") return field;
  if (kind == "ground_truth") return GroundTruth{field, {{0, 1}, {2}}};
  if (kind == "scores") return made_up_scores(n_metrics, rng);
  if (kind == "human_curve") {
    HumanCurve curve;
    for (int n = 0; n < 11; ++n) curve.push_back(made_up_scores(n_metrics, rng));
    return curve;
  }
  throw std::invalid_argument("no made-up value for a result of kind " + std::string(kind));
}

// Means and tables are real, of the made-up maps and scores.
void replace_bodies(Rules& rules, std::size_t n_metrics) {
  for (Rule& rule : rules)
    if (!rule.gathers)
      rule.compute = [stage = rule.stage, kind = rule.kind, n_metrics](const JobInputs& inputs) -> ValuePtr {
        return std::make_shared<const Held<ValueCodec>>(made_up(kind, n_metrics, inputs.random.rng(stage)));
      };
}

void fill(const Arguments& arguments) {
  const std::atomic<bool> stop = false;
  Setup setup(arguments);
  Project& project = setup.project;
  replace_bodies(project.rules, chosen_metrics(setup.config.metrics).size());
  FolderStore store(setup.cache, Access::read_write);
  Resolver resolver(project, make_plan(project, store), store);
  NoProgress progress;
  run(resolver, {.threads = thread_count(arguments)}, progress, stop);
  for (const Failure& failure : resolver.failures())
    std::cerr << project.name(failure.job) << ": " << project.rule(failure.job).stage << ": " << failure.cause
              << '\n';
  std::cout << setup.inputs.text() << ", " << resolver.computed() << " artefacts\n";
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::cerr << "usage: perf_full_cache CONFIG DATA CACHE\n";
    return 2;
  }
  salbench::Arguments arguments;
  arguments.config = argv[1];
  arguments.data = argv[2];
  arguments.cache = argv[3];
  salbench::fill(arguments);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
