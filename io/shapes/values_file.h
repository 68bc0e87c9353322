// SPDX-License-Identifier: GPL-3.0-or-later
// A file with one value per point, or per face, as other programs write it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "stages/core/types.h"

namespace salbench {

// Throws InputError, one line that begins with `name`, unless there are as many values as points, or as faces
// where these may have values too.
void require_value_per_element(std::string_view name, std::size_t n_values, std::size_t n_points,
                               std::size_t n_faces = 0);

// Reads text (a number per line, as .val), NumPy's .npy (io/shapes/npy_file.h) or, by `read_hdf5`, HDF5; the
// content tells which. `name` stands for the file in messages. Throws InputError:
// unreadable, another number of values than above, a value that is not finite.
using ReadValues = std::function<ScalarField(const std::filesystem::path&)>;
ScalarField read_point_values(const std::filesystem::path& path, std::string_view name, std::size_t n_points,
                              const ReadValues& read_hdf5, std::size_t n_faces = 0);

}  // namespace salbench
