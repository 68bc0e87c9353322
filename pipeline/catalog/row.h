// SPDX-License-Identifier: GPL-3.0-or-later
// A row of the catalog, made from the function that does its work. What the row reads, in which order,
// whether it draws random numbers or opens files, and the layout of its result follow from the function's
// signature:
//
//   const RowOf<Normals> normals = catalog.add(Shapes::meshes, {"normals", 1}, mesh_normals, mesh,
//                                              section("normals", config.normals));
//
// The arguments stand for the function's parameters, one for one: a RowOf<T> for a T, prepared<P>(RowOf<T>)
// for a P that is made of a T, an optional RowOf<V> for a view V, which is empty where the row does not read
// it, a section for its options, kRandom for a RandomSource, kView for a View, kFiles<source> for a
// FilesOf<source>, kRemark for a Remark. Anything else does not compile.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/dataset.h"
#include "io/value.h"
#include "pipeline/catalog/preparation.h"
#include "pipeline/catalog/source.h"
#include "pipeline/config/option_text.h"
#include "stages/core/rng.h"

namespace salbench {

// Kinds of shapes: the meshes of a data set, simulated scans of them, and its point clouds.
enum class Shapes : std::uint8_t { meshes, scans, clouds };
template <>
struct EnumNames<Shapes> {
  static constexpr std::array<std::string_view, 3> names{"meshes", "scans", "clouds"};
};
inline constexpr std::array kAllShapes = {Shapes::meshes, Shapes::scans, Shapes::clouds};

// A row has one job per shape of its kind, or one for the data set.
enum class Scope : std::uint8_t { mesh, scan, cloud, set };
template <>
struct EnumNames<Scope> {
  static constexpr std::array<std::string_view, 4> names{"mesh", "scan", "cloud", "set"};
};
constexpr Scope scope_of(Shapes shapes) { return static_cast<Scope>(shapes); }

enum class Source : std::uint8_t { none, shape_file, truth_files, map_file };

// --- parameters that a row's function may have beside values and options ---------------------------------

struct View {
  int index = 0;  // of a scan, 0..kViews-1; enters the key
};

// Files of the item, as they were read for this job.
template <Source source>
struct FilesOf {
  const DatasetItem& item;
  const std::string& name;  // "52", "52_3"
  std::span<const SourceData> data;
};

// Oddity of an item that can be used, for the record of the run: one line, stored beside the result.
struct Remark {
  std::string& text;  // empty: nothing
};

// The results of another row for every shape of a kind, in their order. Each is loaded when asked for.
template <class T>
struct Members {
  std::size_t size = 0;
  const std::function<ValuePtr(std::size_t)>& value;
};

// Inputs of one job, from which its row's function gets its parameters.
struct JobInputs {
  std::vector<ValuePtr> values = {};  // of the rows that are read, in their order
  std::size_t members = 0;            // of a set
  std::function<ValuePtr(std::size_t)> member = {};
  std::vector<SourceData> files = {};
  const DatasetItem* source = nullptr;
  RandomSource random = {};  // the seed, and the item's name
  int view = 0;
  std::string* remark = nullptr;                  // set where a row makes one
  std::shared_ptr<Preparation> preparation = {};  // of the row and family; none: the job's own
};

// --- the row ----------------------------------------------------------------------------------------------

// An options struct as text, one `key: value` per line, with the path of its section in the configuration.
struct OptionLines {
  std::string section;  // "fpfh", "models.PS"
  std::string text;     // all options
  std::string in_key;   // those that enter the key
};

struct RowHead {
  std::string name;  // folder in the cache; the same for all kinds of shapes where the work is the same
  std::int32_t version = 1;  // raised when the output changes; tests/pipeline/golden_test.cpp watches
  std::function<bool(const DatasetItem&)> applies = {};  // to an item and its scans; empty: to every one
  std::size_t limit = 0;                                 // jobs at work at the same time; 0: no limit
  bool only_if_cached = false;  // taken from the cache where it is there, and never computed
};

struct Row : RowHead {
  Shapes shapes = Shapes::meshes;
  std::string_view kind = {};  // layout of its result (io/value.h)
  std::vector<OptionLines> options = {};
  std::vector<std::size_t> inputs = {};  // rows of the catalog, each before this one
  Source source = Source::none;
  bool seeded = false;    // draws random numbers: seed and item enter the key
  bool per_view = false;  // the view enters the key
  bool prepares = false;  // jobs of a family share a Preparation
  bool gathers = false;   // one job for the data set, over all members of its input
  ValuePtr given = {};    // in place of a result: known before the run, and not stored
  std::function<Value(const JobInputs&)> run = {};

  Scope scope() const { return gathers ? Scope::set : scope_of(shapes); }
};

namespace binding {

template <class Parameter, class T>
inline constexpr bool kProvides =
    std::is_same_v<Parameter, T> ||
    (std::is_same_v<Parameter, FieldView> && std::is_same_v<T, ScalarField>) ||
    (std::is_same_v<Parameter, Points> &&
     (std::is_same_v<T, Mesh> || std::is_same_v<T, Scan> || std::is_same_v<T, PointCloud>)) ||
    (std::is_same_v<Parameter, Surface> && (std::is_same_v<T, Mesh> || std::is_same_v<T, Faces>));

}  // namespace binding

// Handle of a row whose result is, or has, a T.
template <class T>
struct RowOf {
  std::size_t row = 0;

  RowOf() = default;
  explicit RowOf(std::size_t the_row) : row(the_row) {}
  template <class Other>
  requires binding::kProvides<T, Other> RowOf(const RowOf<Other>& other)
      : row(other.row) {}  // NOLINT: a Mesh has Points
};

template <class Options>
struct SectionOf {
  std::string path;
  Options options;
};
template <class Options>
SectionOf<Options> section(std::string path, const Options& options) {
  return {std::move(path), options};
}

// A parameter that is made of another row's result, once for all jobs of a family that read it.
template <class T, class Source>
struct PreparedOf {
  RowOf<Source> source;
};
template <class T, class Source>
PreparedOf<T, Source> prepared(const RowOf<Source>& source) {
  return {source};
}

// Arguments for what comes from the job.
inline constexpr struct RandomArgument {
} kRandom;
inline constexpr struct ViewArgument {
} kView;
inline constexpr struct RemarkArgument {
} kRemark;
template <Source source>
struct FilesArgument {};
template <Source source>
inline constexpr FilesArgument<source> kFiles;

namespace binding {

// True if this type of argument can be passed for the parameter.
template <class Parameter, class Argument>
inline constexpr bool kFits = false;
template <class Parameter, class T>
inline constexpr bool kFits<Parameter, RowOf<T>> = kProvides<Parameter, T>;
template <class View>
inline constexpr bool kFits<View, std::optional<RowOf<View>>> = std::is_trivially_copyable_v<View>;
template <class T>
inline constexpr bool kFits<Members<T>, RowOf<T>> = true;
template <class T, class Source>
inline constexpr bool kFits<T, PreparedOf<T, Source>> = true;
template <class Options>
inline constexpr bool kFits<Options, SectionOf<Options>> = true;
template <>
inline constexpr bool kFits<RandomSource, RandomArgument> = true;
template <>
inline constexpr bool kFits<View, ViewArgument> = true;
template <>
inline constexpr bool kFits<Remark, RemarkArgument> = true;
template <Source source>
inline constexpr bool kFits<FilesOf<source>, FilesArgument<source>> = true;

template <class Argument>
inline constexpr bool kPrepared = false;
template <class T, class Source>
inline constexpr bool kPrepared<PreparedOf<T, Source>> = true;

template <class T>
inline constexpr bool kGathers = false;
template <class T>
inline constexpr bool kGathers<Members<T>> = true;

// Records in the row what an argument makes it read.
template <class T>
void describe(Row& row, const RowOf<T>& input) {
  row.inputs.push_back(input.row);
}
template <class View>
void describe(Row& row, const std::optional<RowOf<View>>& input) {
  if (input) describe(row, *input);
}
template <class T, class Source>
void describe(Row& row, const PreparedOf<T, Source>& prepared) {
  describe(row, prepared.source);
  row.prepares = true;
}
template <class Options>
void describe(Row& row, const SectionOf<Options>& section) {
  row.options.push_back({section.path, options_text(section.options), key_text(section.options)});
}
inline void describe(Row& row, const RandomArgument&) { row.seeded = true; }
inline void describe(Row& row, const ViewArgument&) { row.per_view = true; }
inline void describe(Row&, const RemarkArgument&) {}
template <Source source>
void describe(Row& row, const FilesArgument<source>&) {
  row.source = source;
}

// The parameter that an argument stands for. `value` is the next of the job's values, and moves on past the
// one that is taken.
template <class Parameter, class T>
decltype(auto) parameter(const RowOf<T>&, const JobInputs& in, std::size_t& value) {
  if constexpr (kGathers<Parameter>) {
    return Parameter{in.members, in.member};
  } else if constexpr (std::is_same_v<Parameter, Points>) {
    const Value& shape = *in.values[value++];
    if (const auto* mesh = std::get_if<Mesh>(&shape)) return Points(mesh->vertices);
    const auto* scan = std::get_if<Scan>(&shape);
    return scan != nullptr ? Points(scan->points) : Points(std::get<PointCloud>(shape).points);
  } else if constexpr (std::is_same_v<Parameter, Surface>) {
    const Value& shape = *in.values[value++];
    const auto* mesh = std::get_if<Mesh>(&shape);
    return mesh != nullptr ? Surface(mesh->faces) : Surface(std::get<Faces>(shape));
  } else if constexpr (std::is_same_v<Parameter, FieldView>) {
    return FieldView(std::get<ScalarField>(*in.values[value++]));
  } else {
    return std::get<Parameter>(*in.values[value++]);
  }
}
template <class Parameter, class View>
Parameter parameter(const std::optional<RowOf<View>>& input, const JobInputs& in, std::size_t& value) {
  return input ? parameter<Parameter>(*input, in, value) : Parameter{};
}
// Part of a preparation, lent to a job.
template <class T>
struct Lent {
  std::shared_ptr<const T> object;
  operator const T&() const { return *object; }  // NOLINT: stands for the parameter
};
template <class Parameter, class T, class Source>
Lent<T> parameter(const PreparedOf<T, Source>&, const JobInputs& in, std::size_t& value) {
  const auto preparation = in.preparation ? in.preparation : std::make_shared<Preparation>();
  return {preparation->template of<T, Source>(in.values[value++])};
}
template <class Parameter, class Options>
const Options& parameter(const SectionOf<Options>& section, const JobInputs&, std::size_t&) {
  return section.options;
}
template <class Parameter>
const RandomSource& parameter(const RandomArgument&, const JobInputs& in, std::size_t&) {
  return in.random;
}
template <class Parameter>
View parameter(const ViewArgument&, const JobInputs& in, std::size_t&) {
  return {in.view};
}
template <class Parameter>
Remark parameter(const RemarkArgument&, const JobInputs& in, std::size_t&) {
  return {*in.remark};
}
template <class Parameter, Source source>
Parameter parameter(const FilesArgument<source>&, const JobInputs& in, std::size_t&) {
  return {*in.source, in.random.item, in.files};
}

template <class Result, class... Parameters, class... Arguments>
Row make_row(RowHead head, Shapes shapes, const std::function<Result(Parameters...)>& function,
             const Arguments&... arguments) {
  static_assert(sizeof...(Parameters) == sizeof...(Arguments), "one argument for each parameter");
  static_assert((kFits<std::decay_t<Parameters>, Arguments> && ...), "each argument fits its parameter");
  Row row{{std::move(head)}, shapes};
  row.kind = kind_of(Value(Result()));
  static_assert((std::size_t{kPrepared<Arguments>} + ... + 0) <= 1, "a preparation holds one object");
  (describe(row, arguments), ...);
  row.gathers = (kGathers<std::decay_t<Parameters>> || ...);
  row.run = [function, arguments...](const JobInputs& in) -> Value {
    std::size_t value = 0;
    // In braces the parameters are made from left to right.
    const std::tuple<decltype(parameter<std::decay_t<Parameters>>(arguments, in, value))...> parameters{
        parameter<std::decay_t<Parameters>>(arguments, in, value)...};
    return std::apply(function, parameters);
  };
  return row;
}

}  // namespace binding

// The rows, every input before its user.
struct Catalog {
  std::vector<Row> rows;

  // Adds the row that a function makes of its arguments; its handle.
  template <class Function, class... Arguments>
  auto add(Shapes shapes, RowHead head, const Function& function, const Arguments&... arguments) {
    return add_row(std::move(head), shapes, std::function(function), arguments...);
  }

  bool has(Shapes shapes, std::string_view name) const;
  bool reference_is_given() const;  // in place of the data set's own mean
  // Throws std::out_of_range.
  std::size_t index(Shapes shapes, std::string_view name) const;

 private:
  template <class Result, class... Parameters, class... Arguments>
  RowOf<Result> add_row(RowHead head, Shapes shapes, const std::function<Result(Parameters...)>& function,
                        const Arguments&... arguments) {
    rows.push_back(binding::make_row(std::move(head), shapes, function, arguments...));
    return RowOf<Result>(rows.size() - 1);
  }
};

}  // namespace salbench
