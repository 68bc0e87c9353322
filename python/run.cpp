// SPDX-License-Identifier: GPL-3.0-or-later
// A run of the benchmark (pipeline/run/). Python reads its tables from the results folder.
#include "pipeline/run/run.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>
#include <pybind11/stl.h>

#include "io/digest.h"
#include "pipeline/engine/resolver.h"
#include "pipeline/results/counts.h"
#include "pipeline/run/commit.h"
#include "pipeline/run/export.h"
#include "python/arrays.h"
#include "python/caller.h"
#include "python/computing.h"
#include "python/counts.h"
#include "python/front.h"
#include "python/log.h"
#include "python/module.h"
#include "python/request.h"
#include "python/run_values.h"
#include "python/texts.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/metrics/score.h"

namespace salbench::python {
namespace {

// Seconds since 1970.
double seconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// Configuration without models, folders and pictures: if equal, equal maps have equal scores.
std::string protocol_text(Config config) {
  config.models.clear();
  config.data = config.cache = config.output = "";
  config.pictures = Pictures::none;
  config.statistics.leading.clear();
  const std::string yaml = config_yaml(config);
  return yaml.substr(0, yaml.rfind("models:\n"));
}

class Run {
 public:
  Run(const py::object& settings, const py::list& functions)
      : models_(own_models(functions)),
        request_(request_from(
            settings, models_,
            [this](const OwnModel& model, const FunctionInput& input) { return called(model, input); })),
        front_(python_front(settings)) {}

  // Computes what is missing, then writes tables and record.
  void carry_out(py::handle threads, py::handle progress) {
    const int count = thread_count({threads, "threads"});
    in_session(progress, [&] { scores_ = run_and_write(*session_, count); });
    ::malloc_trim(0);  // conclusions follow, whose libraries need as much memory
  }

  // Returns the number of written shapes or maps.
  std::size_t write_export(py::handle threads, py::handle progress, const std::string& to,
                           const std::string& form, const std::string& stages, bool link, bool for_report) {
    const int count = thread_count({threads, "threads"});
    ExportOptions options{.to = to, .stages = stages, .link = link, .for_report = for_report};
    if (!parse_option(form, options.form))
      throw ConfigError("--format " + form + ": must be h5, ply or maps");
    request_ = request_of_export(std::move(request_), options);
    std::size_t written = 0;
    in_session(progress, [&] { written = export_run(*session_, options, count); });
    return written;
  }

  std::string protocol() { return protocol_text(session().setup.config); }
  std::string protocol_name() { return std::string(name_of(session().setup.config.protocol)); }
  bool simulated() { return session().setup.config.simulated(); }
  std::string shard() {
    const auto& shard = session().setup.inputs.shard;
    return shard ? shard->text() : "";
  }
  std::string inputs_text() { return session().setup.inputs.text(); }
  std::vector<std::string> splits() {
    const auto& names = session().setup.inputs.split_names;
    return {names.begin(), names.end()};
  }
  py::str cache() { return file_text(session().setup.cache.string()); }
  py::str output() { return file_text(session().setup.output.string()); }
  std::size_t computed() { return session().resolver.computed(); }
  const std::string& scores() const { return scores_; }

  // Summary of the run, as in the output of commands.
  py::dict summary() {
    const Setup& setup = session().setup;
    py::list failed;
    for (const Failure& failure : session_->resolver.failures())
      failed.append(py::dict(py::arg("item") = file_text(setup.project.name(failure.job)),
                             py::arg("stage") = setup.project.rule(failure.job).stage,
                             py::arg("why") = file_text(failure.cause)));
    return py::dict(py::arg("meshes") = setup.inputs.count(kMeshes),
                    py::arg("clouds") = setup.inputs.count(kClouds),
                    py::arg("models") = setup.config.models.size(), py::arg("cache") = cache(),
                    py::arg("computed") = computed(), py::arg("interrupted") = caller_.stop().load(),
                    py::arg("failed") = failed);
  }

  // Errors of the data set, one line each.
  py::list problems() {
    py::list lines;
    for (const std::string& error : session().setup.inputs.errors) lines.append(file_text(error));
    return lines;
  }
  bool has_defect() { return std::ranges::any_of(session().resolver.failures(), &Failure::defect); }

  // Columns and rows of means.csv as text.
  py::tuple means() {
    const Table table = python::computed([&] { return means_of(session()); });
    py::list rows;
    for (const std::vector<Cell>& cells : table.rows) {
      py::list row;
      for (const Cell& cell : cells) row.append(file_text(csv_text(cell)));
      rows.append(row);
    }
    return py::make_tuple(table.columns, rows);
  }

  // (item, stage, cause) of each failure; a function's traceback follows its cause.
  py::list failures() {
    py::list rows;
    const Project& project = session().setup.project;
    for (const Failure& failure : session_->resolver.failures()) {
      const Rule& rule = project.rule(failure.job);
      std::string cause = failure.cause;
      for (const OwnModel& model : models_)
        if (has_role(rule, Role::map) && model.name == rule.subject)
          if (const auto trace = model.traces.find(project.name(failure.job)); trace != model.traces.end())
            cause += "\n" + trace->second;
      rows.append(py::make_tuple(file_text(project.name(failure.job)), rule.stage, file_text(cause)));
    }
    return rows;
  }

  // Names of shapes, as bytes.
  py::list mapped(const std::string& model) {
    py::list names;
    for (const std::string& name : mapped_items(session(), model)) names.append(py::bytes(name));
    return names;
  }

  void require_model(const std::string& model) {
    row_named("model with maps", model, models_with_maps(session().setup.project));
  }

  // Scores by metric of a shape's map; with an empty model, as the model whose map it is.
  py::dict score(py::handle prediction, const std::string& item, const std::string& model) {
    if (!model.empty()) require_model(model);
    row_named("item in the run", item, shapes_with_maps(session().setup.project));
    const auto n = session().setup.config.on_faces()  // values by face may match either count
                       ? std::nullopt
                       : python::computed([&] { return point_count(*session_, item); });
    const auto map = field({prediction, "prediction"}, n);
    const Metrics metrics = chosen_metrics(session_->setup.config.metrics);
    const Scores scores =
        in_range(metrics, python::computed([&] { return scores_of(*session_, map.copy(), item, model); }));
    py::dict by_metric;
    for (std::size_t m = 0; m < metrics.size(); ++m)
      by_metric[py::str(metrics[m].name)] = py::float_(scores.values[m]);
    return by_metric;
  }

  // (model, maps computed by this run, maps read, times of storage of the first and last map read) per model.
  py::list models() {
    py::list rows;
    for (const MapCount& count : count_maps(session().resolver, session_->store))
      rows.append(
          py::make_tuple(count.model, count.computed, count.read, seconds(count.first), seconds(count.last)));
    return rows;
  }

  // Map of a model; None if it has none of this shape.
  py::object map(const std::string& model, const std::string& item) {
    session();
    const ValuePtr value = python::computed([&] { return map_of(*session_, model, item); });
    if (value == nullptr) return py::none();
    const auto& map = value_as<ScalarField>(*value);
    return read_only(shown(value, std::span<const double>(map)));
  }

 private:
  // Planned on first use.
  Session& session() {
    if (!session_) in_session(py::none(), [] {});
    return *session_;
  }

  void in_session(py::handle progress, const std::function<void()>& work) {
    caller_.run(
        [&] {
          if (!session_) {
            auto counts = std::make_unique<Counts>();
            Counts* const told = counts.get();
            session_.emplace(request_, front_, std::move(counts), caller_.stop());
            counts_ = told;
          }
          work();
        },
        [&] {
          if (counts_ != nullptr) counts_.load()->tell(progress);
        });
  }

  // Runs in the thread that called the run, where its settings hold (torch.no_grad) and Ctrl-C arrives.
  ScalarField called(const OwnModel& model, const FunctionInput& input) {
    ScalarField map;
    std::chrono::duration<double> apart{0};
    caller_.carry_out([&] {
      map = call(model, input);
      if (!model.learner.is_none())
        apart = std::chrono::duration<double>(model.learner.attr("seconds_apart")().cast<double>());
    });
    note_waiting(std::chrono::duration_cast<Clock::duration>(apart));
    return map;
  }

  OwnModels models_;
  Caller caller_;
  std::atomic<Counts*> counts_ = nullptr;
  Request request_;
  Front front_;
  std::optional<Session> session_;
  std::string scores_;
};

}  // namespace

void bind_run(py::module_& module) {
  module.attr("commit") = std::string(commit());
  module.def("protocol", [](const std::string& yaml, const std::string& name) {
    return protocol_text(read_config(Section::from_text(yaml, name), ""));
  });
  module.def("protocol",
             [](const std::string& path) { return protocol_text(read_config(configuration(path), "")); });
  module.def("digest", [](const py::bytes& bytes) { return file_digest(std::string_view(bytes)).hex(); });
  module.def("wrong_with_model_name", &wrong_with_model_name);
  py::class_<Run>(module, "Run")
      .def(py::init<const py::object&, const py::list&>())
      .def("carry_out", &Run::carry_out)
      .def("export", &Run::write_export)
      .def("summary", &Run::summary)
      .def("problems", &Run::problems)
      .def("has_defect", &Run::has_defect)
      .def("means", &Run::means)
      .def("failures", &Run::failures)
      .def("map", &Run::map)
      .def("mapped", &Run::mapped)
      .def("require_model", &Run::require_model)
      .def("score", &Run::score)
      .def("models", &Run::models)
      .def("__reduce__",  // not transferable between processes: pickles as None
           [](const Run&) { return py::make_tuple(py::type::of(py::none()), py::tuple()); })
      .def_property_readonly("cache", &Run::cache)
      .def_property_readonly("output", &Run::output)
      .def_property_readonly("scores", &Run::scores)
      .def_property_readonly("shard", &Run::shard)
      .def_property_readonly("inputs_text", &Run::inputs_text)
      .def_property_readonly("protocol", &Run::protocol)
      .def_property_readonly("protocol_name", &Run::protocol_name)
      .def_property_readonly("simulated", &Run::simulated)
      .def_property_readonly("splits", &Run::splits)
      .def_property_readonly("computed", &Run::computed);
}

}  // namespace salbench::python
