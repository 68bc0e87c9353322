// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/values_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/ground_truth_file.h"
#include "io/shapes/npy_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
// The largest size of a file of n values: a number is never longer when written out, nor is a header.
constexpr std::size_t kBytesPerValue = 64, kHeaderBytes = 1U << 20U;

}  // namespace

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
