// SPDX-License-Identifier: GPL-3.0-or-later
// Invariants of the program itself: a failed check prints the expression and both values.
#pragma once

#include <sstream>
#include <stdexcept>

namespace salbench::detail {

template <class A, class B>
[[noreturn]] void check_failed(const char* expression, const A& a, const B& b, const char* file, int line) {
  std::ostringstream text;
  text << file << ":" << line << ": check failed: " << expression << " (" << a << " against " << b << ")";
  throw std::logic_error(text.str());
}

}  // namespace salbench::detail

#define SALBENCH_CHECK_OP(a, op, b)                                                                \
  do {                                                                                             \
    const auto& check_a_ = (a);                                                                    \
    const auto& check_b_ = (b);                                                                    \
    if (!(check_a_ op check_b_))                                                                   \
      ::salbench::detail::check_failed(#a " " #op " " #b, check_a_, check_b_, __FILE__, __LINE__); \
  } while (false)

#define CHECK_EQ(a, b) SALBENCH_CHECK_OP(a, ==, b)
#define CHECK_LT(a, b) SALBENCH_CHECK_OP(a, <, b)
#define CHECK_LE(a, b) SALBENCH_CHECK_OP(a, <=, b)
#define CHECK_GT(a, b) SALBENCH_CHECK_OP(a, >, b)
