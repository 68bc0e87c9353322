// Files and folders: the one place that opens, reads, writes, renames and lists them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace salbench {

using Bytes = std::vector<std::byte>;

// Throws as read_file does, which opens it next, or another library.
void require_regular_file(const std::filesystem::path& path);

// All bytes of a file that the user named. Throws InputError if it is missing, unreadable or not a regular
// file (pipes and devices never block), StorageError if the system is out of open files or memory.
std::string read_file(const std::filesystem::path& path);

// All bytes of one of our own files; nothing if there is no such file. Throws StorageError if the system does
// not let it be read to its end: that says nothing about the bytes.
std::optional<Bytes> read_bytes(const std::filesystem::path& path);

// Replaces the file in one step: a reader sees the old text or the new one, never a part, even after a crash.
// The folder must exist. Throws StorageError.
void write_file(const std::filesystem::path& path, std::string_view text);

// A file that has a temporary name until it is complete. Its writer holds a lock on it, which dies with the
// process: what killed writers left can be told from what is being written, whatever host or container the
// writer runs on.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& folder);  // throws StorageError, as all of it does
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();  // removes it unless it was finished

  const std::filesystem::path& path() const { return path_; }
  void append(std::span<const std::byte> bytes);
  void finish(const std::filesystem::path& target);  // syncs and renames it, within one file system

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

// Calls `visit` for every unfinished file in the folder whose writer is dead. Where the file system has no
// locks nothing is known to be dead.
void visit_abandoned(const std::filesystem::path& folder,
                     const std::function<void(const std::filesystem::path&)>& visit);

// Entries of the folder, by name; none if there is no such folder. Throws StorageError where it cannot be
// listed to its end.
struct FolderEntry {
  std::filesystem::path path;
  bool is_folder = false;  // also a link to one; a link to nothing is not
};
std::vector<FolderEntry> list_folder(const std::filesystem::path& folder);

// Creates the folder and those above it. Throws StorageError with `advice` ("choose another with --cache").
void make_folder(const std::filesystem::path& folder, std::string_view advice);

// Size in bytes; nothing if there is no such file. Throws StorageError if the system does not tell.
std::optional<std::uintmax_t> size_of_file(const std::filesystem::path& path);

// The system's reason and what to do about it: "Too many open files: use fewer --threads, or ...".
std::string system_reason(int error);

}  // namespace salbench
