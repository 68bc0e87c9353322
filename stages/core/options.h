// Options structs list their fields once, and everything that handles options walks that list: the
// configuration reader, the canonical text that enters a cache key, run.yaml and the help.
//
//   struct PsOptions {
//     bool absolute = false;
//     template <class Self, class Visit>
//     static void fields(Self& self, Visit&& visit) {
//       visit("absolute", self.absolute, "take the magnitude of the projection");
//     }
//   };
//   void check(const PsOptions&);   // throws OptionError; a struct without it accepts every value
//
// A field is a bool, std::int32_t, std::uint64_t, double, std::string or an enum with EnumNames.
#pragma once

#include <span>
#include <string_view>
#include <type_traits>

namespace salbench {

// Specialised beside each enum: `static constexpr std::array<std::string_view, N> names`, by value.
template <class Enum>
struct EnumNames;

template <class Enum>
requires std::is_enum_v<Enum>
constexpr std::string_view name_of(Enum value) {
  return EnumNames<Enum>::names[static_cast<std::size_t>(value)];
}

struct NoOptions {
  template <class Self, class Visit>
  static void fields(Self&, Visit&&) {}
};

template <class Options>
void check(const Options&) {}  // overloaded by the structs that have something to check

}  // namespace salbench
