// SPDX-License-Identifier: GPL-3.0-or-later
// libmatio opens paths only, and trusts what it reads. It gets the bytes as a file in memory, in a child
// process with limits, which sends the numbers or a message back through a pipe. The child of a program with
// threads may use malloc and stdio with glibc, and the library needs nothing else.
#include "io/mat_file.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <matio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kHeader = 128, kVersion = 124;
constexpr rlim_t kSeconds = 60, kMemory = 1U << 30U;  // of the child, beyond what the program has
constexpr char kNumbers = 'n', kMessage = 'm';        // first byte of what the child sends

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
    numbers.push_back(static_cast<double>(number));
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
  if (variable.class_type != MAT_C_CELL) throw InputError("it is no cell array, expected one");
  const std::size_t row = index_in(cell[0]), column = index_in(cell[1]);
  if (variable.rank != 2 || row < 1 || column < 1 || row > variable.dims[0] || column > variable.dims[1])
    throw InputError(fmt::format("it has {} x {} cells, expected cell {}, {}", variable.dims[0],
                                 variable.rank > 1 ? variable.dims[1] : 1, row, column));
  const matvar_t* found =
      Mat_VarGetCell(&variable, static_cast<int>((row - 1) + (column - 1) * variable.dims[0]));
  if (found == nullptr) throw InputError("it is damaged: a cell is missing");
  return *found;
}

ScalarField read_numbers(const std::string& path, const std::string& name,
                         const std::vector<std::string>& cell) {
  Mat_LogInitFunc("salbench", [](int, char*) {});
  const File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
  if (file == nullptr) throw InputError("not a MAT file that can be read");
  const Variable variable(Mat_VarRead(file.get(), name.c_str()), Mat_VarFree);
  if (variable == nullptr) {
    Mat_Rewind(file.get());
    throw InputError(
        fmt::format("no variable {}; the file has {}", in_quotes(name), variables_in(file.get())));
  }
  try {
    return numbers_of(cell.empty() ? *variable : cell_of(*variable, cell));
  } catch (const InputError& error) {
    throw InputError(fmt::format("variable {}: {}", in_quotes(name), error.what()));
  }
}

void write_all(int to, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::write(to, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(1);
    at += written;
    size -= static_cast<std::size_t>(written);
  }
}

// Pages that the program has reserved.
rlim_t present_memory() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

[[noreturn]] void read_and_send(int from, int to, rlim_t memory, const std::string& variable,
                                const std::vector<std::string>& cell) {
  const rlimit time{kSeconds, kSeconds}, space{memory + kMemory, memory + kMemory}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &time);
  ::setrlimit(RLIMIT_AS, &space);
  ::setrlimit(RLIMIT_CORE, &no_core);
  try {
    const ScalarField numbers = read_numbers(fmt::format("/proc/self/fd/{}", from), variable, cell);
    write_all(to, &kNumbers, 1);
    write_all(to, numbers.data(), numbers.size() * sizeof(double));
  } catch (const InputError& error) {
    const std::string message = error.what();
    write_all(to, &kMessage, 1);
    write_all(to, message.data(), message.size());
  } catch (const std::exception&) {
    ::_exit(1);
  }
  ::_exit(0);
}

// --- in the program ---------------------------------------------------------------------------------------

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {
    if (fd < 0) throw StorageError(fmt::format("no memory to read a MAT file: {}", system_reason(errno)));
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close() {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

std::string read_to_end(int from) {
  std::string all;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t got = ::read(from, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return all;
    all.append(part.data(), static_cast<std::size_t>(got));
  }
}

void fill(const Descriptor& file, std::string_view bytes, std::string_view name) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(file.get(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      throw StorageError(fmt::format("{}: no memory to read it: {}", name, system_reason(errno)));
    done += static_cast<std::size_t>(written);
  }
}

// What the child sends; nothing if it does not end well.
std::string sent_by_child(std::string_view bytes, std::string_view name, const std::string& variable,
                          const std::vector<std::string>& cell) {
  static std::mutex one_at_a_time;  // else a child keeps another's pipe open
  const std::lock_guard lock(one_at_a_time);
  const Descriptor file(::memfd_create("mat", MFD_CLOEXEC));
  fill(file, bytes, name);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw StorageError(fmt::format("{}: no pipe to read it: {}", name, system_reason(errno)));
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  const rlim_t memory = present_memory();
  const pid_t child = ::fork();
  if (child < 0) throw StorageError(fmt::format("{}: no process to read it: {}", name, system_reason(errno)));
  if (child == 0) read_and_send(file.get(), to.get(), memory, variable, cell);
  to.close();
  std::string sent = read_to_end(from.get());
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? sent : std::string();
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

}  // namespace

bool is_mat(std::string_view bytes) { return bytes.starts_with("MATLAB "); }

ScalarField parse_mat(std::string_view bytes, std::string_view name, const std::string& variable,
                      const std::vector<std::string>& cell) {
  require_version_5(bytes, name);
  if (variable.empty())
    throw InputError(fmt::format("{}: a MAT file, and the description names no `variable:` in it", name));
  const std::string sent = sent_by_child(bytes, name, variable, cell);
  if (sent.empty())
    throw InputError(fmt::format("{}: damaged: the library crashes reading it; save it again", name));
  if (sent[0] == kMessage) throw InputError(fmt::format("{}: {}", name, sent.substr(1)));
  ScalarField numbers((sent.size() - 1) / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), sent.data() + 1, numbers.size() * sizeof(double));
  return numbers;
}

}  // namespace salbench
