// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pipeline/run/request.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench::python {
namespace {

constexpr int kInOrder = py::array::c_style | py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_;

template <class T>
using Ordered = py::array_t<T, kInOrder>;

std::string shape_of(const py::array& array) {
  if (array.ndim() == 1) return fmt::format("({},)", array.shape(0));
  return fmt::format("({})", fmt::join(array.shape(), array.shape() + array.ndim(), ", "));
}

// Limits the size that a sequence claims: NumPy requests that many elements one by one.
void require_bounded(const Argument& argument) {
  constexpr Py_ssize_t kMost = Py_ssize_t{1} << 27U;  // except for arrays: a gigabyte of pointers
  const py::handle value = argument.value;
  if (!PySequence_Check(value.ptr()) || PyObject_CheckBuffer(value.ptr())) return;
  for (const char* name : {"__array__", "__array_interface__", "__array_struct__"})
    if (py::hasattr(value, name)) return;
  const Py_ssize_t length = PySequence_Size(value.ptr());
  if (length < 0) throw py::error_already_set();
  if (length > kMost) argument.fail(fmt::format("has {} elements: give an array of NumPy", length));
}

// A PyTorch tensor on another device, or with gradients, is no array; its detached values on the CPU are.
py::object values_of(const py::object& value) {
  for (const char* name : {"detach", "cpu", "numpy"})
    if (!py::hasattr(value, name)) return value;
  return value.attr("detach")().attr("cpu")().attr("numpy")();
}

// Passes on NumPy's exceptions that do not concern the argument: out of memory, interrupts.
py::array as_array(const Argument& argument) {
  try {
    if (py::array::check_(argument.value)) {
      const auto array = py::reinterpret_borrow<py::array>(argument.value);
      if (py::hasattr(array, "mask")) argument.fail("must not be a masked array: give its data, and a mask");
      return array;
    }
    require_bounded(argument);
    return py::module_::import("numpy").attr("asarray")(
        values_of(py::reinterpret_borrow<py::object>(argument.value)));
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    argument.fail("must be an array of numbers: " + std::string(py::str(error.value())));
  }
}

// Letters of the NumPy types accepted as values of T, and their description.
template <class T>
constexpr std::pair<std::string_view, const char*> kKinds =
    std::is_floating_point_v<T> ? std::pair{"biuf", "real numbers"}
    : std::is_same_v<T, bool>   ? std::pair{"b", "truth values"}
    : std::is_signed_v<T>       ? std::pair{"i", "whole numbers"}
                                : std::pair{"u", "whole numbers"};

// Array in C order with elements of T. An empty array, as of an empty list, may have any type.
template <class T>
Ordered<T> ordered(const Argument& argument, const py::array& array) {
  const auto& [kinds, what] = kKinds<T>;
  if (array.size() > 0 && kinds.find(array.dtype().kind()) == std::string_view::npos)
    argument.fail(fmt::format("must have {}, not {}", what, std::string(py::str(array.dtype()))));
  return Ordered<T>(array);
}

using Lengths = std::initializer_list<std::optional<std::size_t>>;

// `letter` stands for axes of any length in messages.
py::array shaped(const Argument& argument, Lengths shape, const char* letter = "n") {
  const py::array array = as_array(argument);
  const bool fits = std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim(),
                               [](const std::optional<std::size_t>& length, py::ssize_t found) {
                                 return !length || *length == static_cast<std::size_t>(found);
                               });
  if (fits) return array;
  std::vector<std::string> texts;
  for (const auto& length : shape) texts.push_back(length ? fmt::to_string(*length) : letter);
  argument.fail(fmt::format("must have shape ({}{}), not {}", fmt::join(texts, ", "),
                            texts.size() == 1 ? "," : "", shape_of(array)));
}

template <class T>
View<T> view_of(Ordered<T> values) {
  const std::span<const T> view(values.data(), static_cast<std::size_t>(values.size()));
  return {std::move(values), view};
}

template <class T>
View<T> checked(const Argument& argument, Lengths shape) {
  return view_of(ordered<T>(argument, shaped(argument, shape)));
}

// Length of the first given argument that has one.
std::optional<std::size_t> length_of_first(std::initializer_list<Argument> arguments) {
  for (const Argument& argument : arguments)
    if (argument.given())
      if (const py::array array = as_array(argument); array.ndim() > 0)
        return static_cast<std::size_t>(array.shape(0));
  return {};
}

bool is_coordinate(double x) { return std::abs(x) <= kLargestCoordinate; }  // false for NaN

// Integers of any width; double could not represent all of them.
std::vector<std::int32_t> numbers_of_points(const Argument& argument, const py::array& array, std::size_t n) {
  const char kind = array.dtype().kind();
  const auto check = [&](auto number) {
    if (number < 0 || static_cast<std::uint64_t>(number) >= n)
      argument.fail(fmt::format("must have numbers of points, 0 to {}, not {}",
                                static_cast<std::int64_t>(n) - 1, number));
    return static_cast<std::int32_t>(number);
  };
  std::vector<std::int32_t> numbers;
  const auto read = [&](const auto& whole) {
    numbers.reserve(static_cast<std::size_t>(whole.size()));
    const auto* first = whole.data();
    std::transform(first, first + whole.size(), std::back_inserter(numbers), check);
  };
  if (kind == 'u')
    read(ordered<std::uint64_t>(argument, array));
  else
    read(ordered<std::int64_t>(argument, array));
  return numbers;
}

}  // namespace

void Argument::fail(const std::string& what) const {
  throw py::value_error(fmt::format("{} {}", name, what));
}

Argument required(py::handle value, const char* name) {
  const Argument argument{value, name};
  if (!argument.given()) argument.fail("must be given, not None");
  return argument;
}

View<double> field(const Argument& argument, std::optional<std::size_t> n) {
  return checked<double>(argument, {n});
}

View<double> map_values(const Argument& argument, std::optional<std::size_t> n) {
  const py::array array = as_array(argument);
  const std::span lengths(array.shape(), static_cast<std::size_t>(array.ndim()));
  if (lengths.empty() || std::ranges::max(lengths) != array.size()) {
    // the same for every shape, whatever n it has, so that a run sees that a model fails alike on all
    std::vector<std::string> texts;
    for (const py::ssize_t length : lengths)
      texts.push_back(length == std::ranges::max(lengths) ? "n" : fmt::to_string(length));
    argument.fail(fmt::format("must have shape (n,), not ({})", fmt::join(texts, ", ")));
  }
  const py::array flat = py::reinterpret_borrow<py::array>(array.attr("reshape")(-1));
  return field({flat, argument.name}, n);
}

View<double> rows(const Argument& argument, std::initializer_list<Argument> others) {
  const py::array array = as_array(argument);
  const auto n = length_of_first(others);
  const bool matrix = array.ndim() == 2;
  const bool column = matrix && array.shape(1) == 1 && array.shape(0) > 1 && n != 1U;
  const auto is_n = [&](int axis) { return static_cast<std::size_t>(array.shape(axis)) == *n; };
  const bool transposed = matrix && n && is_n(0) && !is_n(1);
  if ((!matrix && array.ndim() != 1) || column || transposed)
    argument.fail(fmt::format("must have shape ({0},) or (k, {0}), not {1}", n ? fmt::to_string(*n) : "n",
                              shape_of(array)));
  return view_of(ordered<double>(argument, array));
}

View<Vec3> vectors(const Argument& argument, std::optional<std::size_t> n) {
  if (!argument.given()) return {};
  auto [values, coordinates] = checked<double>(argument, {n, 3});
  const std::span view(reinterpret_cast<const Vec3*>(coordinates.data()), coordinates.size() / 3);
  return {std::move(values), view};
}

namespace {

View<Vec3> finite_vectors(const Argument& argument, std::optional<std::size_t> n) {
  View<Vec3> found = vectors(argument, n);
  if (found.size() > std::numeric_limits<std::int32_t>::max()) argument.fail("has more than 2^31 points");
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const double x : found.values[i])
      if (!is_coordinate(x))
        argument.fail(fmt::format("must have finite coordinates of at most 1e50, not {} in row {}", x, i));
  return found;
}

}  // namespace

View<Vec3> points(const Argument& argument, std::optional<std::size_t> n) {
  View<Vec3> points = finite_vectors(argument, n);
  if (points.size() > 0 && !coincide(points) && !wrong_with_extent(points).empty())
    argument.fail("must have an extent of at least 1e-50: scale the coordinates");
  return points;
}

View<Vec3> normals(const Argument& argument, std::size_t n) {
  constexpr double kRounding = 1e-5;  // relative to a length of 1, for any type except half precision
  View<Vec3> normals = finite_vectors(argument, n);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (const double length = normals.values[i].norm(); !(std::abs(length - 1) <= kRounding))
      argument.fail(fmt::format("must have unit length, not {} in row {}", length, i));
  return normals;
}

Descriptors descriptors(const Argument& argument, std::size_t n) {
  const auto values = checked<float>(argument, {n, kFpfhBins});
  Descriptors result;
  result.values.assign(values.values.begin(), values.values.end());
  for (const float value : result.values)
    if (!(value >= 0 && std::isfinite(value)))
      argument.fail(fmt::format("must have finite numbers >= 0, not {}", value));
  return result;
}

Vec3 place(const Argument& argument) {
  const auto values = field(argument, 3);
  for (const double x : values.values)
    if (!is_coordinate(x))
      argument.fail(fmt::format("must have finite coordinates of at most 1e50, not {}", x));
  return {values.values[0], values.values[1], values.values[2]};
}

Faces faces(const Argument& argument, std::size_t n) {
  if (!argument.given()) return {};
  const std::vector<std::int32_t> corners =
      numbers_of_points(argument, shaped(argument, {std::nullopt, 3}, "m"), n);
  Faces result(corners.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]};
  return result;
}

Mesh mesh_from(py::handle points_of, py::handle faces_of) {
  const auto vertices = points(required(points_of, "points"));
  return {vertices.copy(), faces(required(faces_of, "faces"), vertices.size())};
}

std::vector<std::int32_t> indices(const Argument& argument, std::size_t n) {
  if (!argument.given()) return {};
  return numbers_of_points(argument, shaped(argument, {std::nullopt}, "k"), n);
}

std::vector<std::vector<std::int32_t>> picks(const Argument& argument, std::size_t n) {
  if (!argument.given()) return {};
  if (py::isinstance<py::list>(argument.value) || py::isinstance<py::tuple>(argument.value)) {
    const auto sequence = py::reinterpret_borrow<py::sequence>(argument.value);
    if (sequence.size() > 0 && PySequence_Check(py::object(sequence[0]).ptr()) != 0) {
      std::vector<std::vector<std::int32_t>> all;
      for (const py::handle one : sequence) all.push_back(indices({one, argument.name}, n));
      return all;
    }
  }
  return {indices(argument, n)};
}

std::vector<bool> mask(const Argument& argument, std::size_t n) {
  const auto values = checked<bool>(argument, {n});
  return {values.values.begin(), values.values.end()};
}

std::optional<Histogram> histogram(const Argument& argument) {
  if (!argument.given()) return {};
  const auto bins = field(argument, kHistogramBins);
  Histogram densities;
  std::ranges::copy(bins.values, densities.begin());
  return densities;
}

double real_number(const Argument& argument) {
  const double value = PyFloat_AsDouble(argument.value.ptr());
  if (!PyErr_Occurred()) return value;
  if (!PyErr_ExceptionMatches(PyExc_TypeError) && !PyErr_ExceptionMatches(PyExc_OverflowError))
    throw py::error_already_set();
  PyErr_Clear();
  argument.fail("must be a real number that a double can hold");
}

std::uint64_t whole_number(const Argument& argument, std::uint64_t low, std::uint64_t high) {
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(argument.value.ptr()));
  if (!number) {
    if (!PyErr_ExceptionMatches(PyExc_TypeError)) throw py::error_already_set();
    PyErr_Clear();
    argument.fail(fmt::format("must be a whole number, not of type {}",
                              std::string(py::str(py::type::of(argument.value).attr("__name__")))));
  }
  const std::uint64_t value = PyLong_AsUnsignedLongLong(number.ptr());
  const bool fits = !PyErr_Occurred();
  PyErr_Clear();
  if (!fits || value < low || value > high)
    argument.fail(
        fmt::format("must be a whole number from {} to {}, not {}", low, high, std::string(py::str(number))));
  return value;
}

int thread_count(const Argument& argument) {
  if (!argument.given()) {
    const py::module_ os = py::module_::import("os");
    return std::min(static_cast<int>(py::len(os.attr("sched_getaffinity")(0))), kMostThreads);
  }
  return static_cast<int>(whole_number(argument, 1, kMostThreads));
}

py::array shown(Owner owner, py::dtype type, std::vector<py::ssize_t> shape, const void* data) {
  const py::capsule keeper(new Owner(std::move(owner)), [](void* kept) { delete static_cast<Owner*>(kept); });
  return py::array(std::move(type), std::move(shape), data, keeper);
}

py::array shown(Owner owner, const Array& array) {
  return std::visit(
      [&]<class T>(const std::vector<T>& values) {
        return shown(std::move(owner), py::dtype::of<T>(), {array.shape.begin(), array.shape.end()},
                     values.data());
      },
      array.values);
}

py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace salbench::python
