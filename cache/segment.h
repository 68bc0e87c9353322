// SPDX-License-Identifier: GPL-3.0-or-later
// A segment: artefacts of one family in one HDF5 file, which is written once and never changed. Any HDF5
// reader shows the arrays as /STAGE/ITEM/ARRAY. The program reads them through the head, which stands in the
// file's user block, where HDF5 looks at nothing:
//   table    of the artefacts: stage, item, key, content, remark; what a run reads at its start
//   records  one per artefact: recipe, the rest of its note, and where each piece of each array lies
// So no byte is parsed before a checksum has vouched for it, and reading needs no lock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cache/artefact.h"
#include "io/file.h"

namespace salbench {

struct SegmentRow {
  Digest key, content;
  std::string stage, item;
  std::string remark = {};
  std::uint64_t bytes = 0;                       // of its arrays
  std::uint64_t at = 0, size = 0, checksum = 0;  // of its record
};

SegmentRow row_of(const Artefact& artefact);  // but for the place of its record

// Throws InputError where the bytes are not those that were written, and StorageError where the system does
// not let us read them.
class Segment {
 public:
  static std::optional<Segment> open(const std::filesystem::path& file);  // nothing: there is no such file

  const std::vector<SegmentRow>& rows() const { return rows_; }
  std::string group(const SegmentRow& row) const;  // of its arrays: "fpfh/52"

  // `record`: without the pieces of the arrays. Nothing: the file has gone since it was opened.
  enum class Part { record, all };
  std::optional<Artefact> read(const SegmentRow& row, Part part) const;
  void check() const;  // reads all of its bytes
  std::int64_t changed_ns() const { return file_->changed_ns(); }

 private:
  Segment() = default;

  std::optional<OpenFile> file_;
  std::uint64_t head_ = 0;  // bytes, before the HDF5 part
  std::uint64_t body_ = 0, body_checksum_ = 0;
  std::vector<SegmentRow> rows_;
};

// Reads a segment to its end and describes the first damage. Empty if there is none, or if the file has gone.
// Throws StorageError.
std::string damage_in(const std::filesystem::path& file);

// The bytes of a segment, and its checksum. Equal artefacts give equal bytes.
struct SegmentImage {
  std::uint64_t checksum = 0;
  Bytes head, body;
};
SegmentImage segment_image(const std::vector<ArtefactPtr>& artefacts);

// Writes a segment of a family into a cache, and returns its path. Throws StorageError.
std::filesystem::path write_segment(const std::filesystem::path& cache, const std::string& label,
                                    const SegmentImage& image);

}  // namespace salbench
