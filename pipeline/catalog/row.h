// A row of the catalog, made from the function that does its work. What the row reads, in which order, whether
// it draws random numbers or opens files, and the layout of its result follow from the function's signature:
//
//   const RowOf<Normals> normals = catalog.add(Shapes::meshes, {"normals", 1}, mesh_normals, mesh,
//                                              section("normals", config.normals));
//
// Arguments stand for the function's parameters in their order. A RowOf<T> stands for a parameter of type T, a
// section for one of its options type; RandomSource, View and FilesOf come from the job. Anything else does not
// compile.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/dataset.h"
#include "io/value.h"
#include "pipeline/catalog/source.h"
#include "pipeline/config/option_text.h"
#include "stages/core/rng.h"

namespace salbench {

enum class Shapes : std::uint8_t { meshes, scans };
template <>
struct EnumNames<Shapes> {
  static constexpr std::array<std::string_view, 2> names{"meshes", "scans"};
};

// What a row has one job for: each mesh, each scan, or the data set.
enum class Scope : std::uint8_t { mesh, scan, set };
template <>
struct EnumNames<Scope> {
  static constexpr std::array<std::string_view, 3> names{"mesh", "scan", "set"};
};

enum class Source : std::uint8_t { none, mesh_file, truth_files, map_file };

using ValuePtr = std::shared_ptr<const Value>;

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

// The results of another row for every mesh or every scan, in their order. Each is loaded when asked for.
template <class T>
struct Members {
  std::size_t size = 0;
  const std::function<ValuePtr(std::size_t)>& value;
};

// What a job hands to its row's function.
struct JobInputs {
  std::vector<ValuePtr> values = {};  // of the rows that are read, in their order
  std::size_t members = 0;            // of a set
  std::function<ValuePtr(std::size_t)> member = {};
  std::vector<SourceData> files = {};
  const DatasetItem* source = nullptr;
  RandomSource random = {};  // the seed, and the item's name
  int view = 0;
};

// --- the row ----------------------------------------------------------------------------------------------

// Canonical text of an options struct, with the path of its section in the configuration.
struct OptionLines {
  std::string section;  // "fpfh", "models.PS"
  std::string text;     // one `key: value` per line
};

struct RowHead {
  std::string name;          // folder in the cache; the same for meshes and scans where the work is the same
  std::int32_t version = 1;  // raised when the output changes; tests/pipeline/golden_test.cpp watches
  std::function<bool(const DatasetItem&)> applies = {};  // to an item and its scans; empty: to every one
  std::size_t limit = 0;                                 // jobs at work at the same time; 0: no limit
};

struct Row : RowHead {
  Shapes shapes = Shapes::meshes;
  std::string_view kind = {};  // layout of its result (io/value.h)
  std::vector<OptionLines> options = {};
  std::vector<std::size_t> inputs = {};  // rows of the catalog, each before this one
  Source source = Source::none;
  bool seeded = false;            // draws random numbers: seed and item enter the key
  bool per_view = false;          // the view enters the key
  bool gathers = false;           // one job for the data set, over all members of its input
  ValuePtr given = {};             // in place of a result: known before the run, and not stored
  std::function<Value(const JobInputs&)> run = {};

  Scope scope() const {
    if (gathers) return Scope::set;
    return shapes == Shapes::meshes ? Scope::mesh : Scope::scan;
  }
};

namespace binding {

template <class Parameter, class T>
inline constexpr bool kProvides =
    std::is_same_v<Parameter, T> ||
    (std::is_same_v<Parameter, Points> && (std::is_same_v<T, Mesh> || std::is_same_v<T, Scan>)) ||
    (std::is_same_v<Parameter, Surface> && (std::is_same_v<T, Mesh> || std::is_same_v<T, Faces>));

}  // namespace binding

// Handle of a row whose result is, or has, a T.
template <class T>
struct RowOf {
  std::size_t row = 0;

  RowOf() = default;
  explicit RowOf(std::size_t the_row) : row(the_row) {}
  template <class Other>
  requires binding::kProvides<T, Other>
  RowOf(const RowOf<Other>& other) : row(other.row) {}  // NOLINT: a Mesh has Points
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

namespace binding {

template <class T>
inline constexpr Source kSourceOf = Source::none;
template <Source source>
inline constexpr Source kSourceOf<FilesOf<source>> = source;

template <class T>
inline constexpr bool kGathers = false;
template <class T>
inline constexpr bool kGathers<Members<T>> = true;

template <class T>
inline constexpr bool kFromJob =
    std::is_same_v<T, RandomSource> || std::is_same_v<T, View> || kSourceOf<T> != Source::none;

// Whether an argument may stand for a parameter.
template <class Parameter, class Argument>
inline constexpr bool kFits = false;
template <class Parameter, class T>
inline constexpr bool kFits<Parameter, RowOf<T>> = kProvides<Parameter, T>;
template <class T>
inline constexpr bool kFits<Members<T>, RowOf<T>> = true;
template <class Options>
inline constexpr bool kFits<Options, SectionOf<Options>> = true;

template <class T>
inline constexpr bool kIsRow = false;
template <class T>
inline constexpr bool kIsRow<RowOf<T>> = true;

template <class Parameter>
decltype(auto) from_job(const JobInputs& in) {
  if constexpr (std::is_same_v<Parameter, RandomSource>)
    return (in.random);
  else if constexpr (std::is_same_v<Parameter, View>)
    return View{in.view};
  else
    return Parameter{*in.source, in.random.item, in.files};
}

template <class Parameter>
decltype(auto) from_value(const Value& value) {
  if constexpr (std::is_same_v<Parameter, Points>) {
    const auto* mesh = std::get_if<Mesh>(&value);
    return mesh != nullptr ? Points(mesh->vertices) : Points(std::get<Scan>(value).points);
  } else if constexpr (std::is_same_v<Parameter, Surface>) {
    const auto* mesh = std::get_if<Mesh>(&value);
    return mesh != nullptr ? Surface(mesh->faces) : Surface(std::get<Faces>(value));
  } else {
    return std::get<Parameter>(value);
  }
}

// A function's parameters held against the arguments that stand for them.
template <class Parameters, class Arguments>
struct Match;
template <class... Parameters, class... Arguments>
struct Match<std::tuple<Parameters...>, std::tuple<Arguments...>> {
  using ParameterList = std::tuple<Parameters...>;
  using ArgumentList = std::tuple<Arguments...>;
  static constexpr std::array<bool, sizeof...(Parameters)> kJobs{kFromJob<Parameters>...};
  static constexpr std::array<bool, sizeof...(Arguments)> kRows{kIsRow<Arguments>...};

  static constexpr std::size_t argument_of(std::size_t parameter) {
    std::size_t arguments = 0;
    for (std::size_t p = 0; p < parameter; ++p) arguments += kJobs[p] ? 0U : 1U;
    return arguments;
  }
  static constexpr std::size_t value_of(std::size_t argument) {
    std::size_t rows = 0;
    for (std::size_t a = 0; a < argument; ++a) rows += kRows[a] ? 1U : 0U;
    return rows;
  }

  template <std::size_t parameter>
  static constexpr bool fits() {
    if constexpr (kJobs[parameter])
      return true;
    else
      return kFits<std::tuple_element_t<parameter, ParameterList>,
                   std::tuple_element_t<argument_of(parameter), ArgumentList>>;
  }

  template <std::size_t parameter>
  static decltype(auto) get(const JobInputs& in, const ArgumentList& arguments) {
    using Parameter = std::tuple_element_t<parameter, ParameterList>;
    if constexpr (kJobs[parameter]) {
      return from_job<Parameter>(in);
    } else {
      constexpr std::size_t kArgument = argument_of(parameter);
      if constexpr (!kRows[kArgument])
        return (std::get<kArgument>(arguments).options);
      else if constexpr (kGathers<Parameter>)
        return Parameter{in.members, in.member};
      else
        return from_value<Parameter>(*in.values[value_of(kArgument)]);
    }
  }
};

template <class T>
void describe(Row& row, const RowOf<T>& input) {
  row.inputs.push_back(input.row);
}
template <class Options>
void describe(Row& row, const SectionOf<Options>& section) {
  row.options.push_back({section.path, options_text(section.options)});
}

template <class Result, class... Parameters, class... Arguments, std::size_t... P>
Row make_row(RowHead head, Shapes shapes, const std::function<Result(Parameters...)>& function,
             std::index_sequence<P...>, const Arguments&... arguments) {
  using Matched = Match<std::tuple<std::decay_t<Parameters>...>, std::tuple<Arguments...>>;
  static_assert(Matched::argument_of(sizeof...(Parameters)) == sizeof...(Arguments),
                "one argument for each parameter that does not come from the job");
  static_assert((Matched::template fits<P>() && ...), "each argument fits the parameter in its place");
  Row row{{std::move(head)}, shapes};
  row.kind = kind_of(Value(Result()));
  (describe(row, arguments), ...);
  row.seeded = (std::is_same_v<std::decay_t<Parameters>, RandomSource> || ...);
  row.per_view = (std::is_same_v<std::decay_t<Parameters>, View> || ...);
  row.gathers = (kGathers<std::decay_t<Parameters>> || ...);
  for (const Source source : {Source::none, kSourceOf<std::decay_t<Parameters>>...})
    if (source != Source::none) row.source = source;
  row.run = [function, held = std::tuple(arguments...)](const JobInputs& in) -> Value {
    return function(Matched::template get<P>(in, held)...);
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
  // Throws std::out_of_range.
  std::size_t index(Shapes shapes, std::string_view name) const;

 private:
  template <class Result, class... Parameters, class... Arguments>
  RowOf<Result> add_row(RowHead head, Shapes shapes, const std::function<Result(Parameters...)>& function,
                        const Arguments&... arguments) {
    rows.push_back(binding::make_row(std::move(head), shapes, function,
                                     std::index_sequence_for<Parameters...>(), arguments...));
    return RowOf<Result>(rows.size() - 1);
  }
};

}  // namespace salbench
