// SPDX-License-Identifier: GPL-3.0-or-later
// Names and paths in the system's encoding, possibly not valid UTF-8.
#pragma once

#include <string>
#include <vector>

#include <pybind11/pybind11.h>

namespace salbench::python {

namespace py = pybind11;

py::str file_text(const std::string& bytes);
std::string file_bytes(py::handle text);  // inverse of file_text
py::list file_texts(const std::vector<std::string>& all);

}  // namespace salbench::python
