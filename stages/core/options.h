// SPDX-License-Identifier: GPL-3.0-or-later
// Options structs list their fields once, and everything that handles options walks that list: the
// configuration reader, the check of their ranges, the canonical text that enters a cache key, run.yaml and
// the annotated configuration.
//
//   struct XsOptions {
//     double radius = 0.02;
//     bool grow = true;
//     template <class Self, class Visit>
//     static void fields(Self& self, Visit&& visit) {
//       visit("radius", self.radius, {"support radius", "R", above(0)});
//       visit("grow", self.grow, {"enlarge the radius until it holds 6 other points on average"});
//     }
//   };
//
// A field is a bool, std::int32_t, std::uint64_t, double, std::string, a list of texts, an enum with
// EnumNames, or ByName of such an enum. Conditions between fields are an overload of check(), which calls
// check_ranges() first.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

namespace salbench {

// Specialised beside each enum: `static constexpr std::array<std::string_view, N> names`, indexed by value.
template <class Enum>
struct EnumNames;

template <class Enum>
requires std::is_enum_v<Enum>
constexpr std::string_view name_of(Enum value) {
  return EnumNames<Enum>::names[static_cast<std::size_t>(value)];
}

// A value of an enum per name.
template <class Enum>
using ByName = std::map<std::string, Enum, std::less<>>;

// Numbers that an option accepts; by default any finite number.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = true;

  bool contains(double value) const;  // false for infinities and NaN
  std::string text() const;           // ">= 1", "0 < x <= 1"; empty if unbounded
};
constexpr Range at_least(double low) { return {.low = low}; }
constexpr Range above(double low) { return {.low = low, .low_included = false}; }
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }
constexpr Range above_and_up_to(double low, double high) {
  return {.low = low, .high = high, .low_included = false};
}

struct OptionHelp {
  std::string_view text;
  std::string_view unit = {};  // "R": the largest distance of a point to the centroid; empty: dimensionless
  Range range = {};
  // Value, as text, that keys leave out: for options added later, so that results of older versions are still
  // found.
  std::string_view implied = {};
};

// Throws OptionError: key "must be at least 1, not 0".
void check_range(std::string_view key, double value, const Range& range);

// Checks the range of every numeric field. Throws OptionError for the first violation.
template <class Options>
void check_ranges(const Options& options) {
  Options::fields(options, []<class Value>(std::string_view key, const Value& value, const OptionHelp& help) {
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>)
      check_range(key, static_cast<double>(value), help.range);
  });
}

// Throws OptionError.
template <class Options>
void check(const Options& options) {
  check_ranges(options);
}

struct NoOptions {
  template <class Self, class Visit>
  static void fields(Self&, Visit&&) {}
};

}  // namespace salbench
