// SPDX-License-Identifier: GPL-3.0-or-later
// libmatio opens paths only, and trusts what it reads. It gets the bytes as a file in memory, in a child
// process with limits, which sends the numbers or a message. The library needs nothing but malloc and stdio,
// which the child of a program with threads may use.
#include "io/mat_file.h"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include <fmt/format.h>
#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/arrays.h"
#include "io/child_process.h"
#include "io/descriptor.h"
#include "io/file.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kHeader = 128, kVersion = 124;
constexpr ChildLimits kLimits = {.processor_time = std::chrono::seconds(60), .memory = 1U << 30U};

// --- in the child -----------------------------------------------------------------------------------------

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;

template <class Number>
void append_numbers(const matvar_t& variable, std::size_t count, ScalarField& numbers) {
  if (variable.data_size != static_cast<int>(sizeof(Number)) || variable.nbytes / sizeof(Number) < count)
    throw InputError("it is damaged: sizes do not fit");
  for (std::size_t i = 0; i < count; ++i) {
    Number number;
    std::memcpy(&number, static_cast<const char*>(variable.data) + i * sizeof number, sizeof number);
    numbers.push_back(exact_double(number));
  }
}

ScalarField numbers_of(const matvar_t& variable) {
  std::size_t count = 1;
  for (int d = 0; d < variable.rank; ++d) count *= variable.dims[d];
  ScalarField numbers;
  if (count == 0) return numbers;
  if (variable.isComplex != 0 || variable.data == nullptr) throw InputError("it holds no real numbers");
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      append_numbers<double>(variable, count, numbers);
      break;
    case MAT_C_SINGLE:
      append_numbers<float>(variable, count, numbers);
      break;
    case MAT_C_INT8:
      append_numbers<std::int8_t>(variable, count, numbers);
      break;
    case MAT_C_UINT8:
      append_numbers<std::uint8_t>(variable, count, numbers);
      break;
    case MAT_C_INT16:
      append_numbers<std::int16_t>(variable, count, numbers);
      break;
    case MAT_C_UINT16:
      append_numbers<std::uint16_t>(variable, count, numbers);
      break;
    case MAT_C_INT32:
      append_numbers<std::int32_t>(variable, count, numbers);
      break;
    case MAT_C_UINT32:
      append_numbers<std::uint32_t>(variable, count, numbers);
      break;
    case MAT_C_INT64:
      append_numbers<std::int64_t>(variable, count, numbers);
      break;
    case MAT_C_UINT64:
      append_numbers<std::uint64_t>(variable, count, numbers);
      break;
    case MAT_C_CELL:
      throw InputError("it is a cell array: name one with `cell: [row, column]`");
    default:
      throw InputError("it holds no numbers");
  }
  return numbers;
}

std::string variables_in(mat_t* file) {
  std::string names;
  for (int i = 0; i < 10; ++i) {
    const Variable variable(Mat_VarReadNextInfo(file), Mat_VarFree);
    if (variable == nullptr) break;
    names += (names.empty() ? "" : ", ") + in_quotes(variable->name == nullptr ? "" : variable->name);
  }
  return names.empty() ? "none" : names;
}

std::size_t index_in(const std::string& text) {
  std::size_t index = 0;
  std::from_chars(text.data(), text.data() + text.size(), index);
  return index;
}

const matvar_t& cell_of(matvar_t& variable, const std::vector<std::string>& cell) {
  if (variable.class_type != MAT_C_CELL) throw InputError("it is not a cell array: leave out `cell:`");
  const std::size_t row = index_in(cell[0]), column = index_in(cell[1]);
  if (variable.rank != 2 || row < 1 || column < 1 || row > variable.dims[0] || column > variable.dims[1])
    throw InputError(fmt::format("it has {} x {} cells, expected cell {}, {}", variable.dims[0],
                                 variable.rank > 1 ? variable.dims[1] : 1, row, column));
  const matvar_t* found =
      Mat_VarGetCell(&variable, static_cast<int>((row - 1) + (column - 1) * variable.dims[0]));
  if (found == nullptr) throw InputError("it is damaged: a cell is missing");
  return *found;
}

// A request: variable and field of a file.
struct Wanted {
  const std::string& variable;
  std::vector<std::string> cell = {};
  bool row_or_column = false;
};

void require_row_or_column(const matvar_t& variable) {
  const std::vector<std::size_t> shape(variable.dims, variable.dims + variable.rank);
  if (!is_one_per_point(shape))
    throw InputError(fmt::format("its shape is ({}), expected a row or a column", fmt::join(shape, ", ")));
}

ScalarField read_numbers(const std::string& path, const Wanted& wanted) {
  const auto& [name, cell, row_or_column] = wanted;
  Mat_LogInitFunc("salbench", [](int, auto*) {});
  const File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
  if (file == nullptr) throw InputError("not a MAT file that can be read");
  const Variable variable(Mat_VarRead(file.get(), name.c_str()), Mat_VarFree);
  if (variable == nullptr) {
    Mat_Rewind(file.get());
    throw InputError(
        fmt::format("no variable {}; the file has {}", in_quotes(name), variables_in(file.get())));
  }
  try {
    const matvar_t& chosen = cell.empty() ? *variable : cell_of(*variable, cell);
    if (row_or_column) require_row_or_column(chosen);
    return numbers_of(chosen);
  } catch (const InputError& error) {
    throw InputError(fmt::format("variable {}: {}", in_quotes(name), error.what()));
  }
}

// --- in the program ---------------------------------------------------------------------------------------

[[noreturn]] void fail_for_lack_of_memory(std::string_view name) {
  throw StorageError(fmt::format("{}: no memory to read it: {}", name, system_reason(errno)));
}

void fill(const Descriptor& file, std::string_view bytes, std::string_view name) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(file.get(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail_for_lack_of_memory(name);
    done += static_cast<std::size_t>(written);
  }
}

ScalarField read_in_child(std::string_view bytes, std::string_view name, const Wanted& wanted) {
  const Descriptor file(::memfd_create("mat", MFD_CLOEXEC));
  if (file.get() < 0) fail_for_lack_of_memory(name);
  fill(file, bytes, name);
  const std::string path = fmt::format("/proc/self/fd/{}", file.get());
  return numbers_from_child(kLimits, name, [&] { return read_numbers(path, wanted); });
}

void require_version_5(std::string_view bytes, std::string_view name) {
  const auto refuse = [&](std::string_view what) {
    throw InputError(fmt::format("{}: not a MAT file that can be read: {}", name, what));
  };
  if (!is_mat(bytes)) refuse("expected a file of MATLAB, version 5");
  if (bytes.size() < kHeader) refuse("it is cut short");
  const std::string_view version = bytes.substr(kVersion, 4);
  if (version == std::string_view("\0\2IM", 4) || version == std::string_view("\2\0MI", 4))
    refuse("version 7.3 is HDF5; save it with -v7");
  if (version != std::string_view("\0\1IM", 4) && version != std::string_view("\1\0MI", 4))
    refuse("its version is unknown; save it with -v7");
}

ScalarField parsed(std::string_view bytes, std::string_view name, const Wanted& wanted) {
  require_version_5(bytes, name);
  if (wanted.variable.empty())
    throw InputError(fmt::format("{}: a MAT file, and the description names no `variable:` in it", name));
  return read_in_child(bytes, name, wanted);
}

}  // namespace

bool is_mat(std::string_view bytes) { return bytes.starts_with("MATLAB "); }

ScalarField parse_mat_values(std::string_view bytes, std::string_view name, const std::string& variable) {
  return parsed(bytes, name, {.variable = variable, .row_or_column = true});
}

ScalarField parse_mat(std::string_view bytes, std::string_view name, const std::string& variable,
                      const std::vector<std::string>& cell) {
  return parsed(bytes, name, {.variable = variable, .cell = cell});
}

}  // namespace salbench
