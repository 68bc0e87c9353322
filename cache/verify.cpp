// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>

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

  void check(const fs::path& file) try {
    const std::optional<Segment> segment = Segment::open(file);
    if (!segment) return;
    add(segment->rows().size(), size_of_file(file).value_or(0));
    if (const auto name = parse_segment_name(file.filename().native());
        name && file.parent_path() != folder_ / segment_folder(name->label))
      add(file, "it lies in the folder of another family");
    attempt(file, "", [&] { segment->check(); });
    for (const SegmentRow& row : segment->rows())
      attempt(file, segment->is_old() ? "" : fmt::format("{} of {}: ", row.stage, row.item), [&] {
        if (const auto artefact = segment->read(row, Segment::Part::all)) check(file, *artefact);
      });
  } catch (const InputError& error) {
    add(1, size_of_file(file).value_or(0));
    add(file, error.what());
  } catch (const StorageError& error) {
    add(1, 0);
    add(file, error.what());
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
  const std::vector<fs::path> files = list_files(folder);
  Verifier verifier(folder);
  progress.begin("verifying", files.size());
  parallel_ranges(files.size(), 1, [&](std::size_t i, std::size_t) {
    if (stop) return;
    verifier.check(files[i]);
    progress.item_done();
  });
  progress.end();
  Verification result = verifier.take();
  result.others = count_other_files(folder);
  return result;
}

}  // namespace salbench
