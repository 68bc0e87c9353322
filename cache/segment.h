// SPDX-License-Identifier: GPL-3.0-or-later
// A segment is an HDF5 file with artefacts of one family (a mesh with its scans), written once and never
// changed. HDF5 readers see the arrays as /STAGE/ITEM/ARRAY. The program itself reads the file by a head in
// its user block, which HDF5 ignores:
//   table    stage, item, key, content and remark of each artefact; read at the start of a run
//   records  one per artefact: recipe, the rest of its note, and the position of each piece of each array
// Checksums are verified before any byte is parsed, and reading needs no lock.
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
  std::uint64_t bytes = 0;                       // size of the arrays
  std::uint64_t at = 0, size = 0, checksum = 0;  // position in the file, size and checksum of the record
};

SegmentRow row_of(const Artefact& artefact);  // without the position of its record

// Throws InputError if the bytes are not those that were written, StorageError if the system refuses to read
// them.
class Segment {
 public:
  static std::optional<Segment> open(const std::filesystem::path& file);  // nullopt if there is no such file

  const std::vector<SegmentRow>& rows() const { return rows_; }
  std::string group(const SegmentRow& row) const;  // group of the arrays: "fpfh/52"

  // record: without the pieces of the arrays. read() returns nullopt if the file disappeared after opening.
  enum class Part { record, all };
  std::optional<Artefact> read(const SegmentRow& row, Part part) const;
  void check() const;  // reads all bytes
  std::int64_t changed_ns() const { return file_->changed_ns(); }

 private:
  Segment() = default;

  std::optional<OpenFile> file_;
  std::uint64_t head_ = 0;  // bytes before the HDF5 part
  std::uint64_t body_ = 0, body_checksum_ = 0;
  std::vector<SegmentRow> rows_;
};

// Reads a segment to its end and describes the first damage; empty if there is none, or if the file
// disappeared. Throws StorageError.
std::string damage_in(const std::filesystem::path& file);

// Bytes of a segment with their checksum. Equal artefacts give equal bytes.
struct SegmentImage {
  std::uint64_t checksum = 0;
  Bytes head, body;
};
SegmentImage segment_image(const std::vector<ArtefactPtr>& artefacts);

// Writes a family's segment into a cache, and returns its path. Throws StorageError.
std::filesystem::path write_segment(const std::filesystem::path& cache, const std::string& label,
                                    const SegmentImage& image);

}  // namespace salbench
