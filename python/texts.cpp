// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/texts.h"

namespace salbench::python {

py::str file_text(const std::string& bytes) {
  PyObject* text = PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size()));
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

std::string file_bytes(py::handle text) {
  if (py::isinstance<py::bytes>(text)) return text.cast<std::string>();
  PyObject* bytes = PyUnicode_EncodeFSDefault(text.ptr());
  if (bytes == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes).cast<std::string>();
}

py::list file_texts(const std::vector<std::string>& all) {
  py::list list;
  for (const std::string& text : all) list.append(file_text(text));
  return list;
}

}  // namespace salbench::python
