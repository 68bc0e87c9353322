// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "io/descriptor.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// "\040" stands for a blank.
std::string unescaped(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 3 >= text.size()) {
      plain += text[i];
      continue;
    }
    plain += static_cast<char>(std::stoi(text.substr(i + 1, 3), nullptr, 8));
    i += 3;
  }
  return plain;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

bool has_option(const Mount& mount, std::string_view option) {
  return fmt::format(",{},", mount.options).find(fmt::format(",{},", option)) != std::string::npos;
}

// Permissions there say that root may write.
bool is_of_the_system(const Mount& mount) { return mount.type == "proc" || mount.type == "sysfs"; }

template <class Work>
double seconds_of(const Work& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::optional<double> median_of(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  std::ranges::sort(seconds);
  return seconds[seconds.size() / 2];
}

// Asks for the lock of a file whose lock `holder` has, as another process would that opens it.
std::optional<bool> is_refused(const fs::path& path) {
  const Descriptor other(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (other.get() < 0) return {};
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return ::fcntl(other.get(), F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES);
}

std::vector<std::byte> trial_bytes() { return std::vector<std::byte>(kTrialBytes, std::byte{1}); }

}  // namespace

fs::path existing_folder(const fs::path& folder) {
  std::error_code error;
  fs::path found = fs::absolute(folder, error);
  while (!fs::is_directory(found, error) && found.has_relative_path()) found = found.parent_path();
  const fs::path plain = fs::canonical(found, error);
  return error ? found : plain;
}

Mount mount_of(std::string_view mounts, const fs::path& path) {
  Mount found;
  std::istringstream lines{std::string(mounts)};
  for (std::string line; std::getline(lines, line);) {
    // "36 35 98:0 /root /point options, optional fields - type source further-options"
    std::istringstream words(line);
    const std::vector<std::string> fields(std::istream_iterator<std::string>(words), {});
    const auto dash = std::ranges::find(fields, "-");
    if (fields.size() < 6 || fields.end() - dash < 4) continue;
    const std::string point = unescaped(fields[4]);
    if (point.size() >= found.point.size() && is_below(path, point))
      found = {point, dash[1], fields[5] + "," + dash[3]};
  }
  return found;
}

bool is_network(const Mount& mount) {
  static constexpr std::string_view kNetwork[] = {"nfs",  "nfs4",   "cifs", "smb3", "lustre",   "ceph",
                                                  "gpfs", "beegfs", "afs",  "9p",   "glusterfs"};
  return std::ranges::find(kNetwork, mount.type) != std::end(kNetwork) || mount.type.starts_with("fuse.");
}

bool locks_stay_here(const Mount& mount) {
  return has_option(mount, "nolock") || has_option(mount, "local_lock=all") ||
         has_option(mount, "local_lock=posix") || has_option(mount, "localflock");
}

FreeSpace free_space(const fs::path& existing) {
  struct statvfs status {};
  if (::statvfs(existing.c_str(), &status) != 0 || status.f_blocks == 0) return {};  // it does not say
  // Btrfs and others have no limit on files, and say 0.
  return {std::uint64_t{status.f_bavail} * status.f_frsize,
          status.f_files == 0 ? FreeSpace::kNoLimit : std::uint64_t{status.f_favail}};
}

DiskFacts disk_facts(const fs::path& folder) {
  DiskFacts facts{.folder = existing_folder(folder), .mount = {}, .free = {}};
  std::ifstream mounts("/proc/self/mountinfo");
  facts.mount = mount_of(std::string(std::istreambuf_iterator<char>(mounts), {}), facts.folder);
  facts.free = free_space(facts.folder);
  facts.writable = !is_of_the_system(facts.mount) && ::access(facts.folder.c_str(), W_OK | X_OK) == 0;
  return facts;
}

DiskTrial try_disk(const fs::path& scratch) try {
  DiskTrial trial;
  std::vector<double> syncs, renames;
  for (int i = 0; i < kDiskTrials; ++i) {
    UnfinishedFile file(scratch);
    if (i == 0) trial.locks = is_refused(file.path());
    file.append(trial_bytes());
    syncs.push_back(seconds_of([&] { file.sync(); }));
    // Named like an unfinished file, so that it is removed with those if the program dies here.
    const fs::path target =
        fs::path(file.path())
            .replace_filename(file.path().stem().string() + "-renamed" + file.path().extension().string());
    renames.push_back(seconds_of([&] { file.finish_unsynced(target); }));
    remove_file(target);
  }
  trial.sync_seconds = median_of(syncs), trial.rename_seconds = median_of(renames);
  return trial;
} catch (const StorageError&) {
  return {};
}

DiskTrial try_disk_without_names(const fs::path& folder) {
  DiskTrial trial;
  std::vector<double> syncs;
  const std::vector<std::byte> bytes = trial_bytes();
  for (int i = 0; i < kDiskTrials; ++i) {
    const Descriptor file(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
    if (file.get() < 0 || ::write(file.get(), bytes.data(), bytes.size()) != std::ssize(bytes)) return trial;
    bool synced = false;
    const double seconds = seconds_of([&] { synced = ::fsync(file.get()) == 0; });
    if (!synced) return trial;
    syncs.push_back(seconds);
    if (i > 0) continue;
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    const bool held = ::fcntl(file.get(), F_OFD_SETLK, &whole) == 0;
    trial.locks = held ? is_refused(fmt::format("/proc/self/fd/{}", file.get())) : std::optional(false);
  }
  trial.sync_seconds = median_of(syncs);
  return trial;
}

}  // namespace salbench
