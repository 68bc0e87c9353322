// SPDX-License-Identifier: GPL-3.0-or-later
// A run of the benchmark, with models that are functions of Python (pipeline/commands/run.h). The tables are
// those that the command writes, and Python reads them from there.
#include "pipeline/commands/run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/digest.h"
#include "io/shapes/text_scanner.h"
#include "io/shapes/values_file.h"
#include "pipeline/commands/commit.h"
#include "pipeline/commands/plan.h"
#include "pipeline/results/counts.h"
#include "pipeline/rules/function_model.h"
#include "pipeline/rules/given_maps.h"
#include "python/arrays.h"
#include "python/caller.h"
#include "python/computing.h"
#include "python/loaded.h"
#include "python/log.h"
#include "python/module.h"
#include "python/run_values.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/metrics/score.h"

namespace salbench::python {
namespace {

// --- a model ---------------------------------------------------------------------------------------------

// A Function of salbench/_run.py.
struct OwnModel : FunctionModel {
  explicit OwnModel(py::handle row)
      : FunctionModel{.name = row.attr("name").cast<std::string>(),
                      .reads = row.attr("reads").cast<Words>(),
                      .version = row.attr("version").cast<std::int32_t>(),
                      .key = row.attr("key").cast<std::string>(),
                      .trained_keys = row.attr("trained_keys").cast<std::map<std::string, std::string>>(),
                      .trained = row.attr("trained").cast<std::string>(),
                      .trained_on = row.attr("trained_on").cast<Words>(),
                      .description = row.attr("description").cast<std::string>()},
        function(row.attr("predict")) {}

  py::object function;
  mutable std::map<std::string, std::string> traces = {};  // by shape: of what it raised
};

// A copy, since the run forgets its values when it likes; None where the function does not read it.
template <class T>
py::array copied(std::span<const T> values) {
  return read_only(moved(std::vector<T>(values.begin(), values.end())));
}

py::object shape_of(const FunctionInput& input, bool reads_faces) {
  py::object faces = py::none(), normals = py::none(), fpfh = py::none(), source = py::none();
  if (reads_faces) faces = copied<Triangle>(input.faces);
  if (input.normals != nullptr) normals = copied<Vec3>(*input.normals);
  if (input.fpfh != nullptr) fpfh = read_only(moved(std::vector<float>(input.fpfh->values), {-1, kFpfhBins}));
  if (!input.source.empty()) source = file_text(input.source);
  return py::module_::import("salbench._shape")
      .attr("Shape")(file_text(input.item), copied<Vec3>(input.points), faces, normals, fpfh,
                     py::arg("source") = source);
}

// One line, with the user's innermost line: "ValueError: bad (model.py, line 12)"; and the whole traceback.
std::pair<std::string, std::string> what_was_raised(const py::error_already_set& error) {
  const py::object trace = error.trace() ? py::object(error.trace()) : py::none();
  return py::module_::import("salbench._run")
      .attr("_raised")(error.value(), trace)
      .cast<std::pair<std::string, std::string>>();
}

ScalarField call(const OwnModel& model, const FunctionInput& input) {
  try {
    const bool reads_faces = std::ranges::find(model.reads, "faces") != model.reads.end();
    const std::size_t n = input.points.size();
    const py::object values = model.function(shape_of(input, reads_faces));
    const auto map = field({values, "the map"}, input.mapped_faces == 0 ? std::optional(n) : std::nullopt);
    require_value_per_element(fmt::format("{}(): the map", model.name), map.size(), n, input.mapped_faces);
    return {map.values.begin(), map.values.end()};
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;  // Ctrl-C, and sys.exit()
    auto [line, trace] = what_was_raised(error);
    model.traces[input.item] = std::move(trace);
    throw InputError(fmt::format("{}() raised {}", model.name, line));
  } catch (const py::builtin_exception& error) {
    throw InputError(fmt::format("{}(): {}", model.name, error.what()));
  }
}

// Since 1970.
double seconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// --- what is run -----------------------------------------------------------------------------------------

// Counts for whoever asks from the calling thread.
class Counts final : public Progress {
 public:
  void begin(const std::string& what, std::size_t items, std::function<std::string()>) override {
    const std::lock_guard lock(mutex_);
    what_ = what;
    items_ = items;
    done_ = 0;
  }
  void item_done() override { ++done_; }
  void end() override {}

  py::tuple now() const {
    const std::lock_guard lock(mutex_);
    return py::make_tuple(what_, done_.load(), items_);
  }

 private:
  mutable std::mutex mutex_;
  std::string what_;
  std::size_t items_ = 0;
  std::atomic<std::size_t> done_ = 0;
};

std::string text_or_empty(py::handle settings, const char* key) {
  const py::object value = settings.attr(key);
  return value.is_none() ? std::string() : std::string(py::str(value));
}

// The configuration without models, folders and pictures: what makes scores of the same maps the same.
std::string protocol_text(Config config) {
  config.models.clear();
  config.data = config.cache = config.output = "";
  config.pictures = Pictures::none;
  const std::string yaml = config_yaml(config);
  return yaml.substr(0, yaml.rfind("models:\n"));
}

// Those of a list such as "LS,PS"; of an empty one people and chance, which takes part in any case.
void keep_models(Config& config, const std::string& list) {
  if (!list.empty()) return select_models(config, list);
  std::erase_if(config.models, [](const Model& model) { return !is_reference_model(model.name); });
  if (config.models.empty())
    config.models = read_config(Section::from_text("models: {RS: }", "models"), "python").models;
}

// Of the Settings of salbench/_run.py, what a command line would have said: the `path` or name of a
// configuration; `data`, `cache`, `out`, `split`; `reference` where it is a text.
Arguments arguments_from(py::handle settings) {
  Arguments arguments;
  for (const auto& [key, folder] : {std::pair{"path", &arguments.config},
                                    {"data", &arguments.data},
                                    {"cache", &arguments.cache},
                                    {"out", &arguments.output}})
    *folder = text_or_empty(settings, key);
  if (!settings.attr("split").is_none()) arguments.split = text_or_empty(settings, "split");
  if (py::isinstance<py::str>(settings.attr("reference")))
    arguments.reference = text_or_empty(settings, "reference");
  return arguments;
}

// That of the arguments, or `yaml`; with `models`, as YAML, in place of those that it names, or with those of
// its own that are `kept`.
Config config_from(py::handle settings, const Arguments& arguments) {
  const std::string& path = arguments.config;
  Config config = path.empty()
                      ? read_config(Section::from_text(text_or_empty(settings, "yaml"), "config"), "python")
                      : read_config(configuration(path), std::filesystem::path(path).stem().string());
  const std::string models = text_or_empty(settings, "models");
  if (models == "{}") {
    config.models.clear();
  } else if (!models.empty()) {
    const std::string yaml = fmt::format("{{protocol: {}, models: {}}}", name_of(config.protocol), models);
    config.models = read_config(Section::from_text(yaml, "models"), "python").models;
  }
  if (const py::object kept = settings.attr("kept"); !kept.is_none())
    keep_models(config, kept.cast<std::string>());
  place_folders(config, arguments);
  return config;
}

Selection selection_from(py::handle settings, const Arguments& arguments) {
  Selection selection = selection_of(arguments);
  if (const py::object items = settings.attr("items"); !items.is_none()) selection.items = choice_of(items);
  if (const py::object reference = settings.attr("reference");
      !reference.is_none() && !py::isinstance<py::str>(reference))
    selection.reference = histogram({reference, "reference"});
  return selection;
}

// The grid of a variant makes names, too.
void add_model(Config& config, Model model) {
  if (std::ranges::find(config.models, model.name, &Model::name) != config.models.end())
    throw ConfigError(fmt::format("models: {} is the name of two models", in_quotes(model.name)));
  config.models.push_back(std::move(model));
}

using Call = std::function<ScalarField(const OwnModel& model, const FunctionInput& input)>;

// With the functions, which must outlive it, and maps of files.
Config whole_config(py::handle settings, const Arguments& arguments, const std::deque<OwnModel>& functions,
                    const Call& call) {
  Config config = config_from(settings, arguments);
  for (const OwnModel& model : functions)
    add_model(config, function_model(
                          model, [call, &model](const FunctionInput& input) { return call(model, input); }));
  for (const auto& [name, folder] : settings.attr("maps").cast<std::map<std::string, std::string>>())
    add_model(config, given_model(name, find_given_maps(folder, false)));
  return config;
}

// What a run would do.
class Planned {
 public:
  Planned(const py::object& settings, const py::list& functions) {
    std::deque<OwnModel> models;
    for (const py::handle row : functions) models.emplace_back(row);
    const Arguments arguments = arguments_from(settings);
    Config config = whole_config(settings, arguments, models, {});
    const Selection selection = selection_from(settings, arguments);
    const LogDelivery delivery;
    const py::gil_scoped_release others_go_on;
    const Setup setup(std::move(config), selection);
    Json document = {{"schema", kReportSchema}, {"command", "plan"}};
    document.update(plan_report(setup).members);
    document_ = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    const FolderStore store(setup.cache, Access::read_only);
    const Plan plan = make_plan(setup.project, store);
    for (const Job& job : setup.project.jobs())
      if (has_role(setup.project.rule(job), Role::map) && plan[job].open())
        open_[setup.project.rule(job).subject].push_back(setup.project.name(job));
  }

  const std::string& document() const { return document_; }
  // Names of shapes, as bytes, whose map would be computed.
  py::list open(const std::string& model) const {
    py::list names;
    if (const auto found = open_.find(model); found != open_.end())
      for (const std::string& name : found->second) names.append(py::bytes(name));
    return names;
  }

 private:
  std::string document_;
  std::map<std::string, std::vector<std::string>> open_;
};

class Run {
 public:
  Run(const py::object& settings, const py::list& functions) {
    for (const py::handle row : functions) models_.emplace_back(row);
    const Arguments arguments = arguments_from(settings);
    Config config = whole_config(
        settings, arguments, models_,
        [this](const OwnModel& model, const FunctionInput& input) { return called(model, input); });
    const Selection selection = selection_from(settings, arguments);
    auto counts = std::make_unique<Counts>();
    counts_ = counts.get();
    const bool keep_going = settings.attr("keep_going").cast<bool>();
    const LogDelivery delivery;
    const py::gil_scoped_release others_go_on;
    session_.emplace(Setup(std::move(config), selection), std::move(counts), caller_.stop(), keep_going);
  }

  void carry_out(py::handle threads, const py::function& progress) {
    const int count = thread_count({threads, "threads"});
    caller_.run([&] { run_and_write(*session_, count); }, [&] { progress(*counts_->now()); });
  }

  std::string protocol() const { return protocol_text(session_->setup.config); }
  std::vector<std::string> splits() const {
    const auto& names = session_->setup.inputs.split_names;
    return {names.begin(), names.end()};
  }
  std::string cache() const { return session_->setup.cache.string(); }
  std::string output() const { return session_->setup.output.string(); }
  std::size_t computed() const { return session_->resolver.computed(); }

  // (item, stage, cause) of each; below the cause of a function's failure stands its traceback.
  py::list failures() const {
    py::list rows;
    const Project& project = session_->setup.project;
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
  py::list mapped(const std::string& model) const {
    py::list names;
    for (const std::string& name : mapped_items(*session_, model)) names.append(py::bytes(name));
    return names;
  }

  void require_model(const std::string& model) const {
    row_named("model with maps", model, models_with_maps(session_->setup.project));
  }

  // By metric, of a map of a shape; an empty model stands for the one whose map it is.
  py::dict score(py::handle prediction, const std::string& item, const std::string& model) {
    if (!model.empty()) require_model(model);
    row_named("item in the run", item, shapes_with_maps(session_->setup.project));
    const auto n = session_->setup.config.on_faces()  // the rule of values by face counts both
                       ? std::nullopt
                       : python::computed([&] { return point_count(*session_, item); });
    const auto map = field({prediction, "prediction"}, n);
    const Metrics metrics = chosen_metrics(session_->setup.config.metrics);
    const Scores scores =
        in_range(metrics, python::computed([&] {
                   return scores_of(*session_, {map.values.begin(), map.values.end()}, item, model);
                 }));
    py::dict by_metric;
    for (std::size_t m = 0; m < metrics.size(); ++m)
      by_metric[py::str(metrics[m].name)] = py::float_(scores.values[m]);
    return by_metric;
  }

  // (model, maps computed by this run, maps read, when the first and the last of these were stored) of each.
  py::list models() const {
    py::list rows;
    for (const MapCount& count : count_maps(session_->resolver, session_->store))
      rows.append(
          py::make_tuple(count.model, count.computed, count.read, seconds(count.first), seconds(count.last)));
    return rows;
  }

  // The map of a model, or nothing if there is none of this shape.
  py::object map(const std::string& model, const std::string& item) {
    const ValuePtr value = python::computed([&] { return map_of(*session_, model, item); });
    if (value == nullptr) return py::none();
    const auto& map = value_as<ScalarField>(*value);
    return read_only(shown(value, std::span<const double>(map)));
  }

 private:
  // By the thread that called the run.
  ScalarField called(const OwnModel& model, const FunctionInput& input) {
    ScalarField map;
    caller_.carry_out([&] { map = call(model, input); });
    return map;
  }

  std::deque<OwnModel> models_;
  Caller caller_;
  Counts* counts_ = nullptr;
  std::optional<Session> session_;
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
  py::class_<Planned>(module, "Planned")
      .def(py::init<const py::object&, const py::list&>())
      .def_property_readonly("document", &Planned::document)
      .def("open", &Planned::open);
  py::class_<Run>(module, "Run")
      .def(py::init<const py::object&, const py::list&>())
      .def("carry_out", &Run::carry_out)
      .def("failures", &Run::failures)
      .def("map", &Run::map)
      .def("mapped", &Run::mapped)
      .def("require_model", &Run::require_model)
      .def("score", &Run::score)
      .def("models", &Run::models)
      .def("__reduce__",  // of another process there is none: pickled it is None
           [](const Run&) { return py::make_tuple(py::type::of(py::none()), py::tuple()); })
      .def_property_readonly("cache", &Run::cache)
      .def_property_readonly("output", &Run::output)
      .def_property_readonly("protocol", &Run::protocol)
      .def_property_readonly("splits", &Run::splits)
      .def_property_readonly("computed", &Run::computed);
}

}  // namespace salbench::python
