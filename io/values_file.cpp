// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/values_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "io/file.h"
#include "io/ground_truth_file.h"
#include "io/hdf5_file.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in memory");

constexpr std::string_view kNpy = "\x93NUMPY", kHdf5 = "\x89HDF\r\n\x1a\n";
// The largest size of a file of n values: a number is never longer when written out, nor is a header.
constexpr std::size_t kBytesPerValue = 64, kHeaderBytes = 1U << 20U;

template <class Number>
ScalarField numbers_in(std::string_view bytes) {
  ScalarField values(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Number number;
    std::memcpy(&number, bytes.data() + i * sizeof number, sizeof number);
    values[i] = static_cast<double>(number);
  }
  return values;
}

ScalarField read_hdf5(const std::filesystem::path& path, std::string_view name) try {
  // No child process reads it first: this program has threads by now. The command has just written it.
  const Hdf5File file(path, false);
  const std::vector<std::string> sets = file.arrays();
  const auto named = std::find(sets.begin(), sets.end(), "saliency");
  if (named == sets.end() && sets.size() != 1)
    throw InputError(
        fmt::format("it has {} data sets of numbers, expected one, or one called 'saliency'", sets.size()));
  const Array array = file.read(named == sets.end() ? sets[0] : *named);
  return std::visit([](const auto& values) { return ScalarField(values.begin(), values.end()); },
                    array.values);
} catch (const InputError& error) {
  throw InputError(fmt::format("{}: {}", name, error.what()));
}

}  // namespace

bool is_npy(std::string_view bytes) { return bytes.starts_with(kNpy); }

// Magic, version (2 bytes), length of the header (2 bytes; 4 from version 2 on), the header as a Python
// dictionary, the values. The order of rows and columns is one for n and for n x 1.
ScalarField parse_npy(std::string_view bytes, std::string_view name) {
  const auto refuse = [&](std::string_view what) {
    throw InputError(fmt::format("{}: not a .npy file that can be read: {}", name, what));
  };
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  if (bytes.size() < 12) refuse("it is cut short");
  const bool long_header = byte(6) >= 2;
  const std::size_t length = byte(8) | byte(9) << 8U | (long_header ? byte(10) << 16U | byte(11) << 24U : 0);
  const std::size_t begin = long_header ? 12 : 10;
  if (bytes.size() - begin < length) refuse("it is cut short");
  const std::string_view header = bytes.substr(begin, length), body = bytes.substr(begin + length);
  const bool is_double = header.find("'<f8'") != std::string_view::npos;
  if (!is_double && header.find("'<f4'") == std::string_view::npos)
    refuse("its type is neither float32 nor float64, little-endian");
  const std::size_t key = header.find("'shape': (");
  const std::size_t close = header.find(')', std::min(key, header.size()));
  if (key == std::string_view::npos || close == std::string_view::npos) refuse("its header names no shape");
  const std::string_view shape = header.substr(key + 10, close - key - 10);  // "642,", "642, 1"
  const std::size_t comma = std::min(shape.find(','), shape.size());
  const std::string_view columns = shape.substr(std::min(comma + 1, shape.size()));
  if (columns.find_first_not_of(' ') != std::string_view::npos && columns != " 1")
    refuse(fmt::format("its shape is ({}), expected one value per point", shape));
  ScalarField values = is_double ? numbers_in<double>(body) : numbers_in<float>(body);
  if (std::to_string(values.size()) != shape.substr(0, comma))
    refuse(fmt::format("its shape is ({}), and it holds {} values", shape, values.size()));
  return values;
}

ScalarField read_point_values(const std::filesystem::path& path, std::string_view name, std::size_t n) {
  require_regular_file(path);
  if (const auto size = size_of_file(path); size && *size > n * kBytesPerValue + kHeaderBytes)
    throw InputError(fmt::format("{}: {} bytes are too many for {} values", name, *size, n));
  const std::string bytes = read_file(path);
  ScalarField values = is_npy(bytes)              ? parse_npy(bytes, name)
                       : bytes.starts_with(kHdf5) ? read_hdf5(path, name)
                                                  : parse_values(bytes, name);
  if (values.size() != n)
    throw InputError(fmt::format("{}: {} values, but the shape has {} points", name, values.size(), n));
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(values[i]))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}, expected a finite number", name, i, values[i]));
  return values;
}

}  // namespace salbench
