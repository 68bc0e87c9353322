// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "cache/format1.h"
#include "cache/layout.h"
#include "cache/segment.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

class Verifier {
 public:
  explicit Verifier(fs::path folder) : folder_(std::move(folder)) {}

  void check(const SegmentFile& file) try {
    const std::optional<Segment> segment = Segment::open(file.path);
    if (!segment) return;
    add(segment->rows().size(), size_of_file(file.path).value_or(0));
    if (segment->checksum() != file.name.checksum)
      add(file.path, "it is not the file of this name");
    else if (file.path.parent_path() != folder_ / segment_folder(file.name.label))
      add(file.path, "it lies in the folder of another family");
    attempt(file.path, "", [&] { segment->check(); });
    for (const SegmentRow& row : segment->rows())
      attempt(file.path, fmt::format("{} of {}: ", row.stage, row.item),
              [&] { check(file.path, segment->read(row, Segment::Part::all)); });
  } catch (const InputError& error) {
    add(1, size_of_file(file.path).value_or(0));
    add(file.path, error.what());
  } catch (const StorageError& error) {
    add(1, 0);
    add(file.path, error.what());
  }

  void check(const OldArtefact& old) {
    add(1, old.size);
    attempt(old.path, "", [&] {
      if (const std::optional<Artefact> artefact = read_old_artefact(old)) check(old.path, *artefact);
    });
  }

  Verification take() {
    std::ranges::sort(found_.faults, {}, [](const Fault& fault) { return std::tie(fault.file, fault.what); });
    return std::move(found_);
  }

 private:
  void add(std::size_t artefacts, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    found_.artefacts += artefacts;
    found_.bytes += bytes;
  }
  void add(const fs::path& file, std::string what) {
    const std::lock_guard lock(mutex_);
    found_.faults.push_back({file, std::move(what)});
  }

  template <class Check>
  void attempt(const fs::path& file, const std::string& what, const Check& check) try {
    check();
  } catch (const InputError& error) {
    add(file, what + error.what());
  } catch (const StorageError& error) {
    add(file, what + error.what());
  }

  // Sound artefacts of one key have one content.
  void check(const fs::path& file, const Artefact& artefact) {
    if (content_digest(arrays_of(artefact)) != artefact.content)
      throw InputError("its content is not what it was named by");
    const std::lock_guard lock(mutex_);
    const auto [first, is_new] = sound_.try_emplace(artefact.key, artefact.content, file);
    if (first->second.first != artefact.content)
      throw InputError("another content under the key of " + first->second.second.filename().string());
  }

  const fs::path folder_;
  std::mutex mutex_;
  std::map<Digest, std::pair<Digest, fs::path>> sound_;
  Verification found_;
};

}  // namespace

Verification verify_cache(const fs::path& folder, const std::atomic<bool>& stop, Progress& progress) {
  require_cache(folder);
  const std::vector<SegmentFile> segments = list_segments(folder);
  const std::vector<OldArtefact> old = list_old_artefacts(folder);
  Verifier verifier(folder);
  progress.begin("verifying", segments.size() + old.size());
  const auto check_all = [&](const auto& files) {
    parallel_ranges(files.size(), 1, [&](std::size_t i, std::size_t) {
      if (stop) return;
      verifier.check(files[i]);
      progress.item_done();
    });
  };
  check_all(segments);
  check_all(old);
  progress.end();
  Verification result = verifier.take();
  result.others = count_other_files(folder);
  return result;
}

}  // namespace salbench
