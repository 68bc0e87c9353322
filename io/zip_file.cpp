// SPDX-License-Identifier: GPL-3.0-or-later
// libzip reads and writes from memory. What strangers made is read in a child process, which sends the
// entries or a message: a kind, then of each entry the lengths of name and bytes, and these.
#include "io/zip_file.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include "io/child_process.h"
#include "io/file.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::uint64_t kOverhead = 1U << 20U;  // of an archive: its directory, and headers
constexpr std::size_t kLongestName = 255;
constexpr zip_uint16_t kDate = (1U << 5U) | 1U;  // 1980-01-01, the first day that an archive knows
constexpr std::chrono::seconds kTime(120);
constexpr char kEntries = 'e', kMessage = 'm';

struct ZipError : zip_error_t {
  ZipError() { zip_error_init(this); }
  ZipError(const ZipError&) = delete;
  ZipError& operator=(const ZipError&) = delete;
  ~ZipError() { zip_error_fini(this); }
};

using Archive = std::unique_ptr<zip_t, decltype(&zip_discard)>;

// --- written ----------------------------------------------------------------------------------------------

[[noreturn]] void fail_to_write(const char* what) {
  throw std::runtime_error(fmt::format("an archive cannot be written: {}", what));
}

void add(zip_t* archive, const ZipEntry& entry) {
  zip_source_t* source = zip_source_buffer(archive, entry.bytes.data(), entry.bytes.size(), 0);
  if (source == nullptr) fail_to_write(zip_strerror(archive));
  const zip_int64_t index = zip_file_add(archive, entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    fail_to_write(zip_strerror(archive));
  }
  const auto at = static_cast<zip_uint64_t>(index);
  if (zip_set_file_compression(archive, at, ZIP_CM_STORE, 0) != 0 ||
      zip_file_set_dostime(archive, at, 0, kDate, 0) != 0 ||
      zip_file_set_external_attributes(archive, at, 0, ZIP_OPSYS_UNIX, (S_IFREG | 0644U) << 16U) != 0)
    fail_to_write(zip_strerror(archive));
}

// --- read, in the child -----------------------------------------------------------------------------------

void require_good_name(std::string_view name) {
  const auto refuse = [&](const char* what) {
    throw InputError(fmt::format("the entry {} {}", in_quotes(name), what));
  };
  if (name.empty() || name.size() > kLongestName) refuse("has no name of 1 to 255 bytes");
  if (std::ranges::any_of(name,
                          [](unsigned char c) { return c < ' ' || c == 0x7f || c == '\\' || c == ':'; }))
    refuse("has a character in its name that no file of a submission has");
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part.empty() || part == "." || part == "..") refuse("has a path that leaves the folder");
    begin = end + 1;
  }
}

bool is_file_or_folder(zip_t* archive, zip_uint64_t index) {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive, index, 0, &system, &attributes) != 0) return false;
  const std::uint32_t type = (attributes >> 16U) & static_cast<std::uint32_t>(S_IFMT);
  return system != ZIP_OPSYS_UNIX || type == 0 || type == S_IFREG || type == S_IFDIR;
}

// Throws InputError unless the entry unpacks to as many bytes as it declares.
std::string unpacked(zip_t* archive, zip_uint64_t index, const zip_stat_t& declared) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("the entry {} {}", in_quotes(declared.name), what));
  };
  const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(zip_fopen_index(archive, index, 0),
                                                                &zip_fclose);
  if (file == nullptr) refuse(fmt::format("cannot be read: {}", zip_strerror(archive)));
  std::string bytes(declared.size, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const zip_int64_t got = zip_fread(file.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0) refuse(fmt::format("is damaged: {}", zip_file_strerror(file.get())));
    if (got == 0) refuse(fmt::format("is cut short: {} of {} bytes", done, bytes.size()));
    done += static_cast<std::size_t>(got);
  }
  char more = 0;  // the checksum is compared at the end
  const zip_int64_t beyond = zip_fread(file.get(), &more, 1);
  if (beyond < 0) refuse(fmt::format("is damaged: {}", zip_file_strerror(file.get())));
  if (beyond > 0) refuse("unpacks to more than it declares");
  return bytes;
}

std::vector<ZipEntry> entries_of(zip_t* archive, const ZipLimits& limits) {
  const auto n = static_cast<std::uint64_t>(std::max<zip_int64_t>(0, zip_get_num_entries(archive, 0)));
  if (n > limits.entries)
    throw InputError(fmt::format("has {} entries, expected at most {}", n, limits.entries));
  std::vector<ZipEntry> entries;
  std::set<std::string> seen;
  std::uint64_t total = 0;
  for (zip_uint64_t index = 0; index < n; ++index) {
    zip_stat_t declared;
    if (zip_stat_index(archive, index, ZIP_FL_ENC_RAW, &declared) != 0 ||
        (declared.valid & ZIP_STAT_NAME) == 0)
      throw InputError(fmt::format("has an entry that cannot be read: {}", zip_strerror(archive)));
    std::string name = declared.name;
    const bool is_folder = name.ends_with('/') && declared.size == 0;
    require_good_name(is_folder ? std::string_view(name).substr(0, name.size() - 1) : name);
    if (!is_file_or_folder(archive, index))
      throw InputError(fmt::format("the entry {} is a link or a device", in_quotes(name)));
    if (declared.encryption_method != ZIP_EM_NONE)
      throw InputError(fmt::format("the entry {} is encrypted", in_quotes(name)));
    if (!seen.insert(name).second)
      throw InputError(fmt::format("the entry {} is there twice", in_quotes(name)));
    if (is_folder) continue;
    if (declared.size > limits.bytes || (total += declared.size) > limits.bytes)
      throw InputError(
          fmt::format("unpacks to more than {} bytes, the most that its shapes need", limits.bytes));
    entries.push_back({std::move(name), unpacked(archive, index, declared)});
  }
  return entries;
}

std::vector<ZipEntry> parsed(std::string_view bytes, const ZipLimits& limits) {
  constexpr std::size_t kSmallest = 22;  // without entries, which the library takes nothing for as well
  if (bytes.size() < kSmallest) throw InputError("cannot be read as a ZIP archive: it is cut short");
  ZipError error;
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  const Archive archive(
      source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error),
      &zip_discard);
  if (archive == nullptr)
    throw InputError(fmt::format("cannot be read as a ZIP archive: {}", zip_error_strerror(&error)));
  return entries_of(archive.get(), limits);
}

void send_entries(const std::vector<ZipEntry>& entries, const Send& send) {
  const auto send_bytes = [&](const void* data, std::size_t size) {
    send({static_cast<const std::byte*>(data), size});
  };
  send_bytes(&kEntries, 1);
  for (const ZipEntry& entry : entries) {
    const std::uint64_t lengths[2] = {entry.name.size(), entry.bytes.size()};
    send_bytes(lengths, sizeof lengths);
    send_bytes(entry.name.data(), entry.name.size());
    send_bytes(entry.bytes.data(), entry.bytes.size());
  }
}

// An archive may have taken the child over: lengths are what it says. Nothing if they do not fit.
std::optional<std::vector<ZipEntry>> received(std::string_view sent) {
  std::vector<ZipEntry> entries;
  const auto take = [&](std::uint64_t n) {
    const std::string_view part = sent.substr(0, n);
    sent.remove_prefix(part.size());
    return part;
  };
  while (!sent.empty()) {
    std::uint64_t lengths[2] = {};
    const std::string_view head = take(sizeof lengths);
    if (head.size() < sizeof lengths) return {};
    std::memcpy(lengths, head.data(), sizeof lengths);
    ZipEntry entry{std::string(take(lengths[0])), std::string(take(lengths[1]))};
    if (entry.name.size() != lengths[0] || entry.bytes.size() != lengths[1]) return {};
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

std::string zip_of(const std::vector<ZipEntry>& entries) {
  ZipError error;
  zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (target == nullptr) fail_to_write(zip_error_strerror(&error));
  Archive archive(zip_open_from_source(target, ZIP_CREATE | ZIP_TRUNCATE, &error), &zip_discard);
  if (archive == nullptr) fail_to_write(zip_error_strerror(&error));
  for (const ZipEntry& entry : entries) add(archive.get(), entry);
  zip_source_keep(target);  // beyond the archive, for what it holds then
  const std::unique_ptr<zip_source_t, decltype(&zip_source_free)> kept(target, &zip_source_free);
  if (zip_close(archive.get()) != 0) fail_to_write(zip_strerror(archive.get()));
  static_cast<void>(archive.release());
  zip_stat_t size;
  if (zip_source_stat(target, &size) != 0 || zip_source_open(target) != 0) fail_to_write("no memory");
  std::string bytes(size.size, '\0');
  const zip_int64_t got = zip_source_read(target, bytes.data(), bytes.size());
  zip_source_close(target);
  if (got != static_cast<zip_int64_t>(bytes.size())) fail_to_write("no memory");
  return bytes;
}

std::vector<ZipEntry> read_zip(const std::filesystem::path& path, const ZipLimits& limits) {
  const std::string bytes = read_file(path, limits.bytes + kOverhead);
  const ChildLimits child{.processor_time = kTime, .memory = 2 * limits.bytes + (kOverhead << 6U)};
  const auto [sent, failure] = run_in_child(child, [&](const Send& send) {
    try {
      send_entries(parsed(bytes, limits), send);
    } catch (const InputError& error) {
      const std::string message = kMessage + std::string(error.what());
      send(std::as_bytes(std::span(message)));
    }
  });
  if (!failure.empty() || sent.empty())
    throw FileError(path, fmt::format("damaged: the library that reads it {}",
                                      failure.empty() ? "ended the process" : failure));
  if (sent[0] == kMessage) throw FileError(path, sent.substr(1));
  auto entries = received(std::string_view(sent).substr(1));
  if (!entries) throw FileError(path, "damaged: its entries were not sent whole");
  return std::move(*entries);
}

}  // namespace salbench
