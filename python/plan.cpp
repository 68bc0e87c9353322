// SPDX-License-Identifier: GPL-3.0-or-later
// Plans as plain data (pipeline/run/plan.h).
#include "pipeline/run/plan.h"

#include <optional>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include "pipeline/results/record.h"
#include "pipeline/rules/values.h"
#include "python/counts.h"
#include "python/front.h"
#include "python/module.h"
#include "python/request.h"
#include "python/texts.h"

namespace salbench::python {
namespace {

py::dict row_of(const StagePlan& stage) {
  const StageCount& count = stage.count;
  py::list reasons;
  for (const auto& [why, jobs] : count.reasons)
    reasons.append(py::dict(py::arg("why") = file_text(why), py::arg("jobs") = jobs));
  return py::dict(py::arg("stage") = count.stage, py::arg("version") = count.version,
                  py::arg("cached") = count.cached, py::arg("to_compute") = count.compute,
                  py::arg("waiting") = count.wait, py::arg("not_applicable") = count.not_applicable,
                  py::arg("failed") = count.failed, py::arg("artefacts") = stage.artefacts,
                  py::arg("bytes") = stage.bytes, py::arg("reasons") = reasons);
}

class Planned {
 public:
  Planned(const py::object& settings, const py::list& functions)
      : models_(own_models(functions)),
        request_(request_from(settings, models_)),
        front_(python_front(settings)) {}

  py::list rows() {
    py::list rows;
    for (const StagePlan& stage : run().stages) rows.append(row_of(stage));
    return rows;
  }
  std::size_t own_rows() { return run().own_stages; }

  py::dict summary() {
    const auto& [selection, config, inputs, project, cache, output] = run().setup;
    const std::string last_run = state_of_results(output);  // as in run.yaml
    return py::dict(py::arg("open") = run().open(), py::arg("meshes") = inputs.count(kMeshes),
                    py::arg("clouds") = inputs.count(kClouds), py::arg("models") = config.models.size(),
                    py::arg("cache") = file_text(cache.string()),
                    py::arg("results") = file_text(output.string()),
                    py::arg("last_run") = last_run.empty() ? py::object(py::none()) : file_text(last_run));
  }
  std::string inputs_text() { return run().setup.inputs.text(); }

  // Names, as bytes, of shapes whose map would be computed.
  py::list open(const std::string& model) {
    const Project& project = run().setup.project;
    py::list names;
    for (const Job& job : project.jobs())
      if (has_role(project.rule(job), Role::map) && project.rule(job).subject == model &&
          run_->plan[job].open())
        names.append(py::bytes(project.name(job)));
    return names;
  }

  // Plan of one item, without planning the others.
  py::dict item(const std::string& name, const std::string& stage) const {
    ItemPlan planned;
    interruptible(py::none(), [&](Progress&, const std::atomic<bool>&) {
      planned = plan_of_item(request_, front_, name, stage);
    });
    py::list stages, others;
    for (const StageOfItem& each : planned.stages)
      stages.append(py::make_tuple(each.stage, each.state, file_text(each.why)));
    for (const OtherRecipe& other : planned.others)
      others.append(py::make_tuple(file_text(other.file.string()), other.key, file_texts(other.before),
                                   file_texts(other.now)));
    return py::dict(py::arg("stages") = stages, py::arg("key") = planned.key, py::arg("others") = others);
  }

 private:
  // Planned on first use.
  PlannedRun& run() {
    if (!run_)
      interruptible(py::none(), [&](Progress&, const std::atomic<bool>&) { run_.emplace(request_, front_); });
    return *run_;
  }

  OwnModels models_;
  Request request_;
  Front front_;
  std::optional<PlannedRun> run_;
};

py::list plan_graph(const py::object& settings) {
  Graph graph;
  interruptible(py::none(),
                [&, request = request_from(settings), front = python_front(settings)](
                    Progress&, const std::atomic<bool>&) { graph = graph_of_run(request, front); });
  py::list nodes;
  for (const GraphNode& node : graph)
    nodes.append(py::dict(py::arg("node") = node.name, py::arg("stage") = node.stage,
                          py::arg("shapes") = node.shapes, py::arg("per") = node.per,
                          py::arg("version") = node.version, py::arg("options") = file_texts(node.options),
                          py::arg("inputs") = file_texts(node.inputs),
                          py::arg("cuts") = file_texts(node.cuts), py::arg("stratum") = node.stratum,
                          py::arg("to_do") = node.to_do));
  return nodes;
}

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<Planned>(module, "Planned")
      .def(py::init<const py::object&, const py::list&>())
      .def("rows", &Planned::rows)
      .def("summary", &Planned::summary)
      .def("open", &Planned::open)
      .def("item", &Planned::item)
      .def_property_readonly("own_rows", &Planned::own_rows)
      .def_property_readonly("inputs_text", &Planned::inputs_text);
  module.def("plan_graph", &plan_graph);
}

}  // namespace salbench::python
