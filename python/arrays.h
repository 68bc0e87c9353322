// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: the bindings. Arguments arrive as NumPy arrays, or anything convertible to them, and are
// passed to the stages as views; results are returned as arrays without a copy. Nothing is computed here.
// Each .cpp with a bind_ function of module.h has one subject.
//
// This file: arguments and results. A float64 array in C order is not copied; other types, memory orders and
// lists are. Indices are always copied: another thread may change the array after they are checked. A wrong
// argument raises a ValueError that names the argument, the expected shape and the actual one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "io/arrays.h"
#include "stages/core/types.h"

namespace salbench::python {

namespace py = pybind11;

// An argument with its name.
struct Argument {
  py::handle value;
  const char* name;

  bool given() const { return !value.is_none(); }
  [[noreturn]] void fail(const std::string& what) const;  // ValueError: "points must have ..."
};

// An argument that must not be None.
Argument required(py::handle value, const char* name);

// A view with its array.
template <class T>
struct View {
  py::array array;
  std::span<const T> values;

  operator std::span<const T>() const { return values; }  // NOLINT: stands for the parameter
  std::size_t size() const { return values.size(); }
  std::vector<T> copy() const { return {values.begin(), values.end()}; }
};

// (n,) numbers; n if it is known already.
View<double> field(const Argument& argument, std::optional<std::size_t> n = {});
// The same of a map, which may have further axes of length 1, as networks return them.
View<double> map_values(const Argument& argument, std::optional<std::size_t> n = {});
// (k, n), or (n,) as one row; `values` has the k * n numbers. Rejects a matrix whose columns match the length
// of the first given one of `others`, and a single column: they are not rows of maps.
View<double> rows(const Argument& argument, std::initializer_list<Argument> others);
// (n, 3), any numbers. None: empty.
View<Vec3> vectors(const Argument& argument, std::optional<std::size_t> n = {});
// (n, 3), finite, with finite squares; squared distances do not vanish. None: no points.
View<Vec3> points(const Argument& argument, std::optional<std::size_t> n = {});
// The same, of unit length.
View<Vec3> normals(const Argument& argument, std::size_t n);
// (n, 33), finite and >= 0.
Descriptors descriptors(const Argument& argument, std::size_t n);
// (3,), a point.
Vec3 place(const Argument& argument);
// (m, 3) point indices, 0 to n - 1. None: no faces.
Faces faces(const Argument& argument, std::size_t n);
// Copy of the arguments `points` and `faces`, which must not be None.
Mesh mesh_from(py::handle points_of, py::handle faces_of);
// (k,) point indices, 0 to n - 1. None: no points.
std::vector<std::int32_t> indices(const Argument& argument, std::size_t n);
// The same, as a sequence with one array per participant; a single array is one participant.
std::vector<std::vector<std::int32_t>> picks(const Argument& argument, std::size_t n);
// (n,) truth values.
std::vector<bool> mask(const Argument& argument, std::size_t n);
// (100,) densities over [0, 1]. None: nullopt.
std::optional<Histogram> histogram(const Argument& argument);
double real_number(const Argument& argument);
// A scalar of any integer type.
std::uint64_t whole_number(const Argument& argument, std::uint64_t low, std::uint64_t high);
int thread_count(const Argument& argument);  // 1 to kMostThreads; None: all cores available to the process

// Owner of memory that arrays share and keep alive.
using Owner = std::shared_ptr<const void>;
py::array shown(Owner owner, py::dtype type, std::vector<py::ssize_t> shape, const void* data);
py::array shown(Owner owner, const Array& array);
py::array read_only(py::array array);

// (n,); points and triangles (n, 3).
template <class T>
py::array shown(Owner owner, std::span<const T> values) {
  const auto n = static_cast<py::ssize_t>(values.size());
  if constexpr (std::is_arithmetic_v<T>)
    return shown(std::move(owner), py::dtype::of<T>(), {n}, values.data());
  else
    return shown(std::move(owner), py::dtype::of<std::decay_t<decltype(values[0][0])>>(), {n, 3},
                 values.data());
}

// Result as a writable array, reshaped if a shape is given.
template <class T>
py::array moved(std::vector<T> values, const std::vector<py::ssize_t>& shape = {}) {
  const auto owner = std::make_shared<const std::vector<T>>(std::move(values));
  py::array array = shown(owner, std::span<const T>(*owner));
  return shape.empty() ? array : array.reshape(shape);
}

}  // namespace salbench::python
