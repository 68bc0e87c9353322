// SPDX-License-Identifier: GPL-3.0-or-later
// Results, held in memory. The engine sees an object that can be stored; rules see the subject's own types,
// of which the subject says here how they are held and what they provide.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <variant>

#include "io/arrays.h"

namespace salbench {

struct Stored {
  virtual ~Stored() = default;
  virtual Arrays arrays() const = 0;  // as the cache has it
};
using ValuePtr = std::shared_ptr<const Stored>;

// Has, for a type of results, a `Codec`: `Type`, a variant that holds them in memory, and the functions
// `Arrays arrays(const Type&)`, `std::string_view kind(const Type&)`, `Type read(std::string_view kind, const
// Arrays&)`.
template <class T>
struct Holder;

// A tag for one of several outputs of a type has that as its `Type`; a type stands for itself.
template <class T>
struct Tagged {
  using Type = T;
};
template <class T>
requires requires { typename T::Type; }
struct Tagged<T> {
  using Type = typename T::Type;
};

// True if a result of type T has, or is, what a function takes as a Parameter.
template <class Parameter, class T>
inline constexpr bool kProvides = std::is_same_v<Parameter, T>;
template <class T>
inline constexpr bool kProvides<const T*, T> = true;  // of an optional input

// In memory a result is the variant that holds it.
template <class Codec>
struct Held final : Stored {
  template <class T>
  explicit Held(T the_value) : value(std::move(the_value)) {}
  Arrays arrays() const override { return Codec::arrays(value); }
  typename Codec::Type value;
};

template <class T>
const T* value_if(const Stored& stored) {
  const auto* held = dynamic_cast<const Held<typename Holder<T>::Codec>*>(&stored);
  return held == nullptr ? nullptr : std::get_if<T>(&held->value);
}
// Throws std::bad_cast.
template <class T>
const T& value_as(const Stored& stored) {
  return std::get<T>(dynamic_cast<const Held<typename Holder<T>::Codec>&>(stored).value);
}
template <class T>
ValuePtr held(T value) {
  return std::make_shared<const Held<typename Holder<T>::Codec>>(std::move(value));
}

// The parameter within a result; a subject adds its views of several types.
template <class Parameter>
struct Part {
  static const Parameter& of(const Stored& stored) { return value_as<Parameter>(stored); }
};
template <class T>
struct Part<const T*> {
  static const T* of(const Stored& stored) { return &value_as<T>(stored); }
};

}  // namespace salbench
