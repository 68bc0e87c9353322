// SPDX-License-Identifier: GPL-3.0-or-later
// Files and folders: the only code that opens, reads, writes, renames and lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "io/descriptor.h"

namespace salbench {

using Bytes = std::vector<std::byte>;

// Upper limit for one file of an item, or one data set in a file: 2 GiB. As text, that is a mesh of 25
// million vertices, whose descriptors alone take 3.3 GB; a larger file is damaged or unusable.
inline constexpr std::uint64_t kMaxItemBytes = std::uint64_t{1} << 31U;

// All bytes of a file that the user named. Throws InputError if it is missing, unreadable, larger than `most`
// or memory, or not a regular file (pipes and devices never block); StorageError if the system is out of file
// descriptors.
std::string read_file(const std::filesystem::path& path,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

// First `bytes` bytes of such a file, or fewer if it is shorter.
std::string read_head(const std::filesystem::path& path, std::size_t bytes);

// All bytes of one of our own files; nullopt if there is no such file. Throws StorageError if the system
// refuses to read it, which says nothing about the bytes.
std::optional<Bytes> read_bytes(const std::filesystem::path& path);

// One of our own files, read in parts. Throws StorageError like read_bytes.
class OpenFile {
 public:
  static std::optional<OpenFile> open(const std::filesystem::path& path);  // nullopt if there is no such file

  std::uint64_t size() const { return size_; }
  std::int64_t changed_ns() const { return changed_ns_; }   // since 1970: content, name or owner
  Bytes read(std::uint64_t at, std::uint64_t bytes) const;  // fewer at the end of the file

 private:
  OpenFile(std::filesystem::path path, Descriptor file, std::uint64_t size, std::int64_t changed_ns)
      : path_(std::move(path)), file_(std::move(file)), size_(size), changed_ns_(changed_ns) {}

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t size_;
  std::int64_t changed_ns_;
};

// Replaces the file atomically: readers see the old text or the new one, even after a crash. The folder must
// exist. Throws StorageError.
void write_file(const std::filesystem::path& path, std::string_view text);

// A file under a temporary name until it is complete. Its writer holds a lock that ends with the process,
// which distinguishes files of dead writers from files in use, on any host or container.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& folder);  // all members throw StorageError
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();  // removes it unless it was finished

  const std::filesystem::path& path() const { return path_; }
  void append(std::span<const std::byte> bytes);
  void finish(const std::filesystem::path& target);  // syncs and renames it, within a file system
  // The same without waiting for the disk: until sync_file returns, a crash of the machine can leave the file
  // short or corrupt. For files whose readers verify them.
  void finish_unsynced(const std::filesystem::path& target);

 private:
  void rename_to(const std::filesystem::path& target);

  std::filesystem::path path_;
  int fd_ = -1;
};

// Returns when the file's bytes are on the disk; does nothing if there is no such file. Throws StorageError.
void sync_file(const std::filesystem::path& path);

// Calls `visit` for every unfinished file in the folder whose writer is dead; finds none on a file system
// without locks.
void visit_abandoned(const std::filesystem::path& folder,
                     const std::function<void(const std::filesystem::path&)>& visit);

struct FolderEntry {
  std::filesystem::path path;
  bool is_folder = false;  // true for links to a folder, except dangling ones
};

bool is_folder(const std::filesystem::path& path);  // false if the system cannot tell

void require_folder(const std::filesystem::path& path);  // throws InputError with the reason

// Entries of the folder, sorted by name; none if there is no such folder. Throws StorageError if it cannot be
// listed completely.
std::vector<FolderEntry> list_folder(const std::filesystem::path& folder);

// The same, unsorted, without the time and memory for paths.
void visit_names(const std::filesystem::path& folder,
                 const std::function<void(std::string_view name, bool is_folder)>& visit);

// Creates the folder and its parents. Throws StorageError with `advice` ("choose another with --cache").
void make_folder(const std::filesystem::path& folder, std::string_view advice);

std::string lower_case_extension(const std::filesystem::path& path);  // ".ply" of "a.PLY"

// Removes a file if it exists. Throws StorageError.
void remove_file(const std::filesystem::path& path);

// Renames a file. False if the system refuses; true if the file no longer exists.
bool move_file(const std::filesystem::path& from, const std::filesystem::path& to);

// Size in bytes; nullopt if there is no such file. Throws StorageError if the system refuses.
std::optional<std::uintmax_t> size_of_file(const std::filesystem::path& path);

// The system's reason with advice: "Too many open files: use fewer --threads, or ...".
std::string system_reason(int error);

// File that the system refused, or failure to start a thread, with reason and advice.
std::string refusal_text(const std::system_error& refusal);

}  // namespace salbench
