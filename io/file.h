// SPDX-License-Identifier: GPL-3.0-or-later
// Files and folders: the one place that opens, reads, writes, renames and lists them.
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

// The most that is read of one file of an item, and of one data set in a file: 2 GiB. As text that is a mesh
// of 25 million vertices, whose descriptors alone take 3.3 GB; a larger file is damaged, or no shape to
// compare.
inline constexpr std::uint64_t kMaxItemBytes = std::uint64_t{1} << 31U;

// All bytes of a file that the user named. Throws InputError if it is missing, unreadable, larger than `most`
// or memory, or not a regular file (pipes and devices never block), StorageError if the system is out of open
// files.
std::string read_file(const std::filesystem::path& path,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

// The first bytes of such a file, or as many as it has.
std::string read_head(const std::filesystem::path& path, std::size_t bytes);

// All bytes of one of our own files; nothing if there is no such file. Throws StorageError if the system does
// not let us read it to its end: that says nothing about the bytes.
std::optional<Bytes> read_bytes(const std::filesystem::path& path);

// One of our own files, read in parts. Throws StorageError as read_bytes does.
class OpenFile {
 public:
  static std::optional<OpenFile> open(const std::filesystem::path& path);  // nothing if there is no such file

  std::uint64_t size() const { return size_; }
  std::int64_t changed_ns() const { return changed_ns_; }   // since 1970: its content, name or owner
  Bytes read(std::uint64_t at, std::uint64_t bytes) const;  // as many of them as there are

 private:
  OpenFile(std::filesystem::path path, Descriptor file, std::uint64_t size, std::int64_t changed_ns)
      : path_(std::move(path)), file_(std::move(file)), size_(size), changed_ns_(changed_ns) {}

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t size_;
  std::int64_t changed_ns_;
};

// Replaces the file in one step: a reader sees the old text or the new one, never a part, even after a crash.
// The folder must exist. Throws StorageError.
void write_file(const std::filesystem::path& path, std::string_view text);

// A file that has a temporary name until it is complete. Its writer holds a lock on it, which dies with the
// process. So files left behind by killed writers can be told from files in use, on any host or container.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& folder);  // all members throw StorageError
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();  // removes it unless it was finished

  const std::filesystem::path& path() const { return path_; }
  void append(std::span<const std::byte> bytes);
  void finish(const std::filesystem::path& target);  // syncs and renames it, within one file system
  // The same without waiting for the disk. A crash of the whole machine can leave the file short or with
  // other bytes until sync_file has returned: for files whose readers check them.
  void finish_unsynced(const std::filesystem::path& target);

 private:
  void rename_to(const std::filesystem::path& target);

  std::filesystem::path path_;
  int fd_ = -1;
};

// Returns when the file's bytes are on the disk; at once if there is no such file. Throws StorageError.
void sync_file(const std::filesystem::path& path);

// Calls `visit` for every unfinished file in the folder whose writer is dead; for none on a file system
// without locks.
void visit_abandoned(const std::filesystem::path& folder,
                     const std::function<void(const std::filesystem::path&)>& visit);

struct FolderEntry {
  std::filesystem::path path;
  bool is_folder = false;  // also true for a link to one, but not for a dangling link
};

bool is_folder(const std::filesystem::path& path);  // false as well where the system does not say

// Entries of the folder, by name; none if there is no such folder. Throws StorageError if it cannot be listed
// to its end.
std::vector<FolderEntry> list_folder(const std::filesystem::path& folder);

// The same in no order, without the time and memory of paths.
void visit_names(const std::filesystem::path& folder,
                 const std::function<void(std::string_view name, bool is_folder)>& visit);

// Creates the folder and those above it. Throws StorageError with `advice` ("choose another with --cache").
void make_folder(const std::filesystem::path& folder, std::string_view advice);

std::string lower_case_extension(const std::filesystem::path& path);  // ".ply" of "a.PLY"

// Removes a file, if there is one. Throws StorageError.
void remove_file(const std::filesystem::path& path);

// Renames a file. False where the system refuses; true as well if there is no such file any more.
bool move_file(const std::filesystem::path& from, const std::filesystem::path& to);

// Size in bytes; nothing if there is no such file. Throws StorageError if the system refuses.
std::optional<std::uintmax_t> size_of_file(const std::filesystem::path& path);

// The system's reason and what to do about it: "Too many open files: use fewer --threads, or ...".
std::string system_reason(int error);

// The file that the system refused and why, or why there is no thread, and what to do about it.
std::string refusal_text(const std::system_error& refusal);

}  // namespace salbench
