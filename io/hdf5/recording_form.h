// SPDX-License-Identifier: GPL-3.0-or-later
// A recording of gaze in the one form, below recording/.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5/form_reader.h"
#include "stages/core/gaze.h"

namespace salbench {

// Names as UTF-8, each with a line feed behind it, and back.
std::vector<std::uint8_t> bytes_of_lines(const std::vector<std::string>& lines);
std::vector<std::string> lines_in_bytes(const std::vector<std::uint8_t>& bytes);

void add_recording(Arrays& arrays, const GazeRecording& recording);

// Empty where the arrays have none. Throws InputError for one that no stage could work on, with the first
// row, from 0, that is wrong.
GazeRecording recording_in(const FormReader& in);

}  // namespace salbench
