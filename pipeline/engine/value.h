// SPDX-License-Identifier: GPL-3.0-or-later
// Results in memory, as the engine passes them on; their types are known to the application only.
#pragma once

#include <any>
#include <memory>
#include <utility>

namespace salbench {

using ValuePtr = std::shared_ptr<const std::any>;

template <class T>
ValuePtr held(T value) {
  return std::make_shared<const std::any>(std::in_place_type<T>, std::move(value));
}
template <class T>
const T* value_if(const std::any& value) {
  return std::any_cast<T>(&value);
}
// Throws std::bad_any_cast.
template <class T>
const T& value_as(const std::any& value) {
  return std::any_cast<const T&>(value);
}

// Converts a result of type T to a function's parameter: the result itself, or an application's view of it.
template <class Parameter, class T>
struct View;
template <class T>
struct View<T, T> {
  static const T& of(const T& value) { return value; }
};
template <class T>
struct View<const T*, T> {  // optional input
  static const T* of(const T& value) { return &value; }
};

template <class Parameter, class T>
concept SeenIn = requires(const T& value) {
  View<Parameter, T>::of(value);
};

}  // namespace salbench
