// SPDX-License-Identifier: GPL-3.0-or-later
// Included by the sources that scripts/mutate rewrites. SALBENCH_MUTANT is the number of the mutant that
// runs; without it every function below does what the original operator does.
#pragma once

#include <cstdlib>

namespace salbench_mutant {

inline const long active = std::getenv("SALBENCH_MUTANT") ? std::atol(std::getenv("SALBENCH_MUTANT")) : -1;

inline bool is(long id) { return id == active; }

inline bool flipped(long id, bool value) { return is(id) ? !value : value; }

template <class T>
T plus_one(long id, T value) {
  return is(id) ? static_cast<T>(value + T{1}) : value;
}

template <class T>
T minus_one(long id, T value) {
  return is(id) ? static_cast<T>(value - T{1}) : value;
}

template <class T>
T positive(long id, T value) {  // of a value that the original negates
  return is(id) ? value : static_cast<T>(-value);
}

template <class T>
T opposite(long id, T value) {  // of the right-hand side of += and -=
  return is(id) ? static_cast<T>(-value) : value;
}

template <class T>
T inverse(long id, T value) {  // of the right-hand side of *= and /=
  return is(id) ? static_cast<T>(T{1} / value) : value;
}

template <class T>
T or_default(long id, T value) {
  if (is(id)) return T{};
  return value;
}

#define SALBENCH_MUTATED_OPERATOR(name, original, mutated) \
  template <class A, class B>                              \
  auto name(long id, A a, B b) {                           \
    using Result = decltype(a original b);                 \
    return is(id) ? Result(a mutated b) : a original b;    \
  }
SALBENCH_MUTATED_OPERATOR(less, <, <=)
SALBENCH_MUTATED_OPERATOR(less_equal, <=, <)
SALBENCH_MUTATED_OPERATOR(greater, >, >=)
SALBENCH_MUTATED_OPERATOR(greater_equal, >=, >)
SALBENCH_MUTATED_OPERATOR(plus, +, -)
SALBENCH_MUTATED_OPERATOR(minus, -, +)
SALBENCH_MUTATED_OPERATOR(times, *, /)
SALBENCH_MUTATED_OPERATOR(divided_by, /, *)
SALBENCH_MUTATED_OPERATOR(modulo, %, *)
#undef SALBENCH_MUTATED_OPERATOR

}  // namespace salbench_mutant
