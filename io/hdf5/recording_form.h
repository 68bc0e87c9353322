// SPDX-License-Identifier: GPL-3.0-or-later
// A gaze recording in the HDF5 form, below recording/.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5/form_reader.h"
#include "stages/core/gaze.h"

namespace salbench {

// Names as UTF-8, each followed by a line feed, and back.
std::vector<std::uint8_t> bytes_of_lines(const std::vector<std::string>& lines);
std::vector<std::string> lines_in_bytes(const std::vector<std::uint8_t>& bytes);

void add_recording(Arrays& arrays, const GazeRecording& recording);

// Empty if the arrays have none. Throws InputError for an unusable recording, with its first wrong row
// (0-based).
GazeRecording recording_in(const FormReader& in);

}  // namespace salbench
