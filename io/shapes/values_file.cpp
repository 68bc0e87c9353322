// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/values_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/ground_truth_file.h"
#include "io/shapes/text_scanner.h"
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

// The text of a key's value in the header of .npy, to the end of the header; empty if it has no such key.
std::string_view value_of(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) return {};
  header.remove_prefix(at + key.size());
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

// "642,", "642, 1"; nothing for text that is no such list.
std::optional<std::vector<std::size_t>> shape_in(std::string_view text) {
  std::vector<std::size_t> shape;
  while (!text.empty()) {
    std::size_t extent = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), extent);
    if (error != std::errc()) return {};
    shape.push_back(extent);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty() && text[0] != ',') return {};
    text.remove_prefix(std::min(text.find_first_not_of(", "), text.size()));
  }
  return shape;
}

bool is_one_per_point(const std::vector<std::size_t>& shape) {
  return std::ranges::count_if(shape, [](std::size_t extent) { return extent != 1; }) <= 1;
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
  const std::string_view type = value_of(header, "'descr':");
  const bool is_double = type.starts_with("'<f8'");
  if (!is_double && !type.starts_with("'<f4'"))
    refuse(fmt::format("its type is {}, neither float32 nor float64, little-endian",
                       in_quotes(type.substr(0, type.find(", 'fortran_order'")))));
  std::string_view text = value_of(header, "'shape': (");
  text = text.substr(0, text.find(')'));
  const std::optional<std::vector<std::size_t>> shape = shape_in(text);
  if (!shape || shape->empty()) refuse("its header names no shape");
  if (!is_one_per_point(*shape)) refuse(fmt::format("its shape is ({}), expected one value per point", text));
  const std::size_t count = *std::ranges::max_element(*shape),
                    size = is_double ? sizeof(double) : sizeof(float);
  if (body.size() % size != 0 || body.size() / size != count)
    refuse(fmt::format("its shape is ({}), and it holds {} bytes of values", text, body.size()));
  return is_double ? numbers_in<double>(body) : numbers_in<float>(body);
}

void require_value_per_element(std::string_view name, std::size_t n_values, std::size_t n_points,
                               std::size_t n_faces) {
  if (n_values != n_points && (n_faces == 0 || n_values != n_faces))
    throw InputError(fmt::format("{}: {} values, but the shape has {} points{}", name, n_values, n_points,
                                 n_faces == 0 ? "" : fmt::format(" and {} faces", n_faces)));
}

ScalarField read_point_values(const std::filesystem::path& path, std::string_view name, std::size_t n_points,
                              const ReadValues& read_hdf5, std::size_t n_faces) {
  require_regular_file(path);
  const std::size_t most = std::max(n_points, n_faces);
  if (const auto size = size_of_file(path); size && *size > most * kBytesPerValue + kHeaderBytes)
    throw InputError(fmt::format("{}: {} bytes are too many for {} values", name, *size, most));
  const std::string bytes = read_file(path);
  ScalarField values = is_npy(bytes)              ? parse_npy(bytes, name)
                       : bytes.starts_with(kHdf5) ? read_hdf5(path)
                                                  : parse_values(bytes, name);
  require_value_per_element(name, values.size(), n_points, n_faces);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}, expected a finite number", name, i, values[i]));
  return values;
}

}  // namespace salbench
