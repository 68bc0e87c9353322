// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>
#include <tuple>
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
  explicit Verifier(const fs::path& folder) : files_(list_segments(folder)) {}

  std::size_t files() const { return files_.size(); }

  void check(std::size_t number) {
    std::vector<Sound> sound;
    check(files_[number], [&](const Artefact& artefact) {
      sound.push_back({artefact.key, artefact.content, static_cast<std::uint32_t>(number)});
    });
    const std::lock_guard lock(mutex_);
    std::ranges::move(sound, std::back_inserter(sound_));
  }

  bool any_fault() const { return !found_.faults.empty(); }

  Verification take() {
    require_one_content();
    std::ranges::sort(found_.faults, {}, [](const Fault& fault) { return std::tie(fault.file, fault.what); });
    return std::move(found_);
  }

 private:
  // Compact: a million shapes have twenty million of these.
  struct Sound {
    Digest key, content;
    std::uint32_t file = 0;
  };

  template <class Keep>
  void check(const fs::path& file, const Keep& keep) try {
    const std::optional<Segment> segment = Segment::open(file);
    if (!segment) return;
    add(segment->rows().size(), size_of_file(file).value_or(0));
    bool is_sound = true;
    for (const SegmentRow& row : segment->rows())
      is_sound &= attempt(file, named(row), [&] {
        const auto artefact = segment->read(row, Segment::Part::all);
        if (!artefact) return;
        if (content_digest(arrays_of(*artefact)) != artefact->content)
          throw InputError("its content does not match its digest");
        keep(*artefact);
      });
    if (is_sound) attempt(file, "", [&] { segment->check(); });  // bytes outside of all artefacts
  } catch (const InputError& error) {
    add(1, size_of_file(file).value_or(0));
    add(file, error.what());
  } catch (const StorageError& error) {
    add(1, 0);
    add(file, error.what());
  }

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
  bool attempt(const fs::path& file, const std::string& what, const Check& check) try {
    check();
    return true;
  } catch (const InputError& error) {
    add(file, what + error.what());
    return false;
  } catch (const StorageError& error) {
    add(file, what + error.what());
    return false;
  }

  static std::string named(const SegmentRow& row) { return fmt::format("{} of {}: ", row.stage, row.item); }

  // Undamaged artefacts of the same key must have equal content; the first file is the reference.
  void require_one_content() {
    std::ranges::sort(sound_, {}, [](const Sound& sound) { return std::tie(sound.key, sound.file); });
    const Sound* first = nullptr;
    for (const Sound& sound : sound_) {
      if (first == nullptr || first->key != sound.key) first = &sound;
      if (first->content != sound.content) add_other_content(sound, files_[first->file]);
    }
  }
  void add_other_content(const Sound& sound, const fs::path& first) {
    const fs::path& file = files_[sound.file];
    std::string of;
    attempt(file, "", [&] {
      if (const std::optional<Segment> segment = Segment::open(file))
        for (const SegmentRow& row : segment->rows())
          if (row.key == sound.key) of = named(row);
    });
    add(file, fmt::format("{}another content under the key of {}", of, first.filename().string()));
  }

  const std::vector<fs::path> files_;
  std::mutex mutex_;
  std::vector<Sound> sound_;
  Verification found_;
};

}  // namespace

Verification verify_cache(const fs::path& folder, const std::atomic<bool>& stop, Progress& progress) {
  require_cache(folder);
  Verifier verifier(folder);
  progress.begin("verifying", verifier.files());
  parallel_ranges(verifier.files(), 1, [&](std::size_t i, std::size_t) {
    if (stop) return;
    verifier.check(i);
    progress.item_done();
  });
  progress.end();
  if (verifier.any_fault()) forget_check(folder);
  Verification result = verifier.take();
  result.others = count_other_files(folder);
  return result;
}

}  // namespace salbench
