// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a rule from the function that does its work. The function's signature determines what the rule reads,
// in which order, whether it draws random numbers or opens files, and the layout of its result:
//
//   const Output<Normals> normals = table.add(level, {.stage = "normals"}, mesh_normals, mesh,
//                                             section("normals", config.normals));
//
// Each argument corresponds to one parameter: an Output<T> to a T, or to Members<T>, which gathers all units;
// only_if(needed, Output<V>) to a view V; prepared<P>(Output<T>) to a P that is built from a T once per
// family; together<Struct>(...) to a struct of several; a SectionOf<Options> to its options; kRandom to a
// RandomSource, kPlace to a UnitPlace, kName to a UnitName, kRemark to a Remark, files_of() to Files,
// text_of() to a UnitText. Anything else does not compile.
#pragma once

#include <any>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include "pipeline/engine/rule.h"
#include "pipeline/engine/value.h"

namespace salbench {

// --- parameters beside values and options ------------------------------------------------------------------

struct UnitPlace {
  std::uint32_t index = 0;  // index of the unit below its parent; enters the key
};

// Files of a unit, as read for this job.
struct Files {
  const std::any& source;   // source of the unit's family
  const std::string& name;  // name of the unit
  std::span<const FileData> data;
};

// Name of the unit, for messages only: results do not depend on it.
struct UnitName {
  const std::string& text;
};

// Part of a unit's key besides files and values.
struct UnitText {
  const std::string& text;
};

// Note on an unusual unit that can still be used: one line, stored beside the result.
struct Remark {
  std::string& text;  // empty: no remark
};

// Known results for all units of a level, in order. Each is loaded when accessed.
template <class T>
struct Members {
  std::size_t size = 0;
  const std::function<ValuePtr(std::size_t)>& value;

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < size; ++i) visit(value_as<T>(*value(i)));
  }
};

// --- arguments: the parameters that each fits, its effect on the rule, and its value -----------------------

// A type that a rule can compute: it has an artefact layout, which a view has not.
template <class T>
concept Result = requires {
  ArrayForm<T>::kind;
};

// A rule's result, or a view of it.
template <class T>
class Output {
 public:
  Output() = default;
  explicit Output(std::size_t rule) : rule_(rule) {}
  template <class Made>
  requires(!std::is_same_v<Made, T> && SeenIn<T, Made>)
      Output(const Output<Made>& made)  // NOLINT: a Mesh has Points
      : rule_(made.rule()),
        view_([](const std::any& value) { return View<T, Made>::of(value_as<Made>(value)); }) {}

  std::optional<std::size_t> rule() const { return rule_; }

  template <class Parameter>
  static constexpr bool fits = SeenIn<Parameter, T> || std::is_same_v<Parameter, Members<T>>;
  void describe(Rule& reader) const {
    if (rule_) reader.inputs.push_back(*rule_);
  }
  template <class Parameter>
  decltype(auto) take(const JobInputs& in, std::size_t& next) const {
    if constexpr (std::is_same_v<Parameter, Members<T>>) {
      return Parameter{in.members, in.member};
    } else if constexpr (!Result<T>) {
      return rule_ ? view_(*in.values[next++]) : T{};
    } else if constexpr (std::is_same_v<Parameter, T>) {
      return value_as<T>(*in.values[next++]);
    } else {  // a view, or a pointer
      return rule_ ? View<Parameter, T>::of(value_as<T>(*in.values[next++])) : Parameter{};
    }
  }

 private:
  std::optional<std::size_t> rule_;       // nullopt: not read
  T (*view_)(const std::any&) = nullptr;  // extracts a view
};

// The view or pointer is empty if the argument is not needed.
template <class T>
Output<T> only_if(bool needed, const Output<T>& output) {
  return needed ? output : Output<T>();
}

// A T that is built from a result and lives as long as it.
template <class T, class Source>
struct Prepared {
  Output<Source> source;

  struct Made {
    explicit Made(ValuePtr from) : source(std::move(from)), object(value_as<Source>(*source)) {}
    ValuePtr source;
    T object;
  };
  struct Lent {
    std::shared_ptr<const Made> made;
    operator const T&() const { return made->object; }  // NOLINT: stands for the parameter
  };
  template <class Parameter>
  static constexpr bool fits = std::is_same_v<Parameter, T>;
  void describe(Rule& reader) const { source.describe(reader); }
  template <class Parameter>
  Lent take(const JobInputs& in, std::size_t& next) const {
    const ValuePtr& of = in.values[next++];
    const ValuePtr made = in.once([&] { return held(std::make_shared<const Made>(of)); });
    return {value_as<std::shared_ptr<const Made>>(*made)};
  }
};
template <class T, class Source>
Prepared<T, Source> prepared(const Output<Source>& source) {
  return {source};
}

// Several arguments as one parameter: a struct with a member for each, in this order, whose `Parameters` are
// the types that they would have as separate parameters.
template <class Struct, class Parameters, class... Arguments>
struct Together;
template <class Struct, class... Parameters, class... Arguments>
struct Together<Struct, std::tuple<Parameters...>, Arguments...> {
  std::tuple<Arguments...> arguments;

  template <class Parameter>
  static constexpr bool fits = std::is_same_v<Parameter, Struct>;
  void describe(Rule& reader) const {
    std::apply([&](const auto&... each) { (each.describe(reader), ...); }, arguments);
  }
  template <class>
  Struct take(const JobInputs& in, std::size_t& next) const {
    return std::apply(
        [&](const auto&... each) { return Struct{each.template take<Parameters>(in, next)...}; }, arguments);
  }
};
template <class Struct, class... Arguments>
Together<Struct, typename Struct::Parameters, Arguments...> together(const Arguments&... arguments) {
  return {{arguments...}};
}

template <class Options>
struct SectionOf {
  OptionLines lines;
  Options options;

  template <class Parameter>
  static constexpr bool fits = std::is_same_v<Parameter, Options>;
  void describe(Rule& reader) const { reader.options.push_back(lines); }
  template <class Parameter>
  const Options& take(const JobInputs&, std::size_t&) const {
    return options;
  }
};

// An argument provided by the job itself: its effect on the rule, and its value.
template <class Wanted>
struct OfJob {
  std::function<void(Rule& reader)> describe;
  Wanted (*get)(const JobInputs& in);

  template <class Parameter>
  static constexpr bool fits = std::is_same_v<Parameter, Wanted>;
  template <class>
  Wanted take(const JobInputs& in, std::size_t&) const {
    return get(in);
  }
};
inline const OfJob<RandomSource> kRandom = {[](Rule& reader) { reader.seeded = true; },
                                            [](const JobInputs& in) { return in.random; }};
inline const OfJob<UnitPlace> kPlace = {[](Rule& reader) { reader.placed = true; },
                                        [](const JobInputs& in) { return UnitPlace{in.place}; }};
inline const OfJob<UnitName> kName = {[](Rule&) {},
                                      [](const JobInputs& in) { return UnitName{in.random.item}; }};
inline const OfJob<Remark> kRemark = {[](Rule& reader) { reader.remarks = true; },
                                      [](const JobInputs& in) { return Remark{*in.remark}; }};

inline OfJob<Files> files_of(const FilesOfUnits& files, bool expected = true) {
  return {[=](Rule& reader) {
            reader.files = files;
            reader.files_expected = expected;
          },
          [](const JobInputs& in) {
            return Files{*in.source, in.random.item, in.files};
          }};
}
inline OfJob<UnitText> text_of(const KeyText& text) {
  return {[=](Rule& reader) { reader.text = text; }, [](const JobInputs& in) { return UnitText{in.text}; }};
}

// --- the table ---------------------------------------------------------------------------------------------

template <class T>
inline constexpr bool kGathers = false;
template <class T>
inline constexpr bool kGathers<Members<T>> = true;

// Rules in dependency order: every input before its reader.
class RuleTable {
 public:
  explicit RuleTable(Rules rules = {}) : rules_(std::move(rules)) {}

  // Adds the rule that applies a function to its arguments.
  template <class Function, class... Arguments>
  auto add(Level over, RuleHead head, const Function& function, const Arguments&... arguments) {
    return add_rule(over, std::move(head), std::function(function), arguments...);
  }
  // Sets the result of a rule before the run. The rule then reads nothing.
  template <class T>
  void give(const Output<T>& output, T value) {
    Rule& rule = rules_.at(output.rule().value());
    rule.given = held(std::move(value));
    rule.inputs.clear();
  }
  const Rules& rules() const { return rules_; }
  Rules take() && { return std::move(rules_); }

 private:
  template <class Made, class... Parameters, class... Arguments>
  Output<Made> add_rule(Level over, RuleHead head, const std::function<Made(Parameters...)>& function,
                        const Arguments&... arguments) {
    static_assert(sizeof...(Parameters) == sizeof...(Arguments), "one argument for each parameter");
    static_assert((Arguments::template fits<std::decay_t<Parameters>> && ...), "each argument fits");
    Rule rule{std::move(head), {}, {}, over};
    (arguments.describe(rule), ...);
    rule.gathers = (kGathers<std::decay_t<Parameters>> || ...);
    rule.kind = ArrayForm<Made>::kind;
    rule.arrays = [](const std::any& value) { return ArrayForm<Made>::arrays(value_as<Made>(value)); };
    rule.read = [](const Arrays& arrays) { return held(ArrayForm<Made>::read(arrays)); };
    rule.compute = [function, arguments...](const JobInputs& in) -> ValuePtr {
      std::size_t next = 0;
      // A braced list evaluates from left to right.
      const std::tuple<decltype(arguments.template take<std::decay_t<Parameters>>(in, next))...> parameters{
          arguments.template take<std::decay_t<Parameters>>(in, next)...};
      return held<Made>(std::apply(function, parameters));
    };
    rules_.push_back(std::move(rule));
    return Output<Made>(rules_.size() - 1);
  }

  Rules rules_;
};

}  // namespace salbench
