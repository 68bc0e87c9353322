// SPDX-License-Identifier: GPL-3.0-or-later
//   0   kMagic
//   16  checksum of the table, which ends with the last row
//   24  table: bytes of the head, of the table, of the HDF5 part; the checksum of the HDF5 part; rows
//       records, and zeros up to a power of two: where HDF5 looks for its part
// Numbers take 8 bytes, little-endian. Positions of pieces are relative to the HDF5 part.
#include "cache/segment.h"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/hdf5/head.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::string_view kMagic = "salbench cache 2";
constexpr std::size_t kTableAt = kMagic.size() + sizeof(std::uint64_t);
constexpr std::size_t kFirstRead = 4096;  // bytes; most tables are shorter

using View = std::span<const std::byte>;

View bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

// --- records ----------------------------------------------------------------------------------------------

void add(FieldWriter& out, const Recipe& recipe) {
  out.add(recipe.stage);
  out.add(static_cast<std::uint64_t>(recipe.stage_version));
  out.add(recipe.options);
  out.add(recipe.seed);
  out.add(recipe.inputs.size());
  for (const auto& [name, digest] : recipe.inputs) {
    out.add(name);
    out.add(digest);
  }
}

Recipe recipe_in(FieldReader& in) {
  Recipe recipe;
  recipe.stage = in.text();
  recipe.stage_version = static_cast<std::int32_t>(in.number());
  recipe.options = in.text();
  recipe.seed = in.text();
  recipe.inputs.resize(in.count());
  for (auto& [name, digest] : recipe.inputs) {
    name = in.text();
    digest = in.digest();
  }
  return recipe;
}

using Pieces = std::vector<std::vector<FilePiece>>;  // [array], over all artefacts

Bytes record_of(const Artefact& artefact, Pieces::const_iterator pieces) {
  FieldWriter out;
  add(out, artefact.recipe);
  out.add(artefact.kind);
  out.add(artefact.note.item);
  out.add(std::bit_cast<std::uint64_t>(artefact.note.seconds));
  add(out, artefact.note.attributes);
  out.add(artefact.content);
  out.add(artefact.arrays.size());
  for (const PackedArray& array : artefact.arrays) add(out, array, *pieces++);
  return std::move(out.bytes);
}

// Leaves out the arrays, which follow in `in`.
Artefact artefact_in(FieldReader& in) {
  Artefact artefact;
  artefact.recipe = recipe_in(in);
  artefact.kind = in.text();
  artefact.note.item = in.text();
  artefact.note.seconds = std::bit_cast<double>(in.number());
  artefact.note.attributes = attributes_in(in);
  artefact.key = key_of(artefact.recipe);
  artefact.content = in.digest();
  return artefact;
}

// --- the table --------------------------------------------------------------------------------------------

struct Table {
  std::uint64_t head = 0, body = 0, body_checksum = 0;
  std::vector<SegmentRow> rows = {};
};

Bytes table_bytes(const Table& table, std::uint64_t bytes) {
  FieldWriter out;
  for (const std::uint64_t number : {table.head, bytes, table.body, table.body_checksum}) out.add(number);
  out.add(table.rows.size());
  for (const SegmentRow& row : table.rows) {
    out.add(row.key);
    out.add(row.content);
    for (const std::uint64_t number : {row.bytes, row.at, row.size, row.checksum}) out.add(number);
    out.add(row.stage);
    out.add(row.item);
    out.add(row.remark);
  }
  return std::move(out.bytes);
}

// --- the HDF5 part ----------------------------------------------------------------------------------------

// Appends the key to the name if artefacts share stage and label.
class Groups {
 public:
  void add(const std::string& stage, const std::string& item) { ++count_[plain(stage, item)]; }
  std::string of(const std::string& stage, const std::string& item, const Digest& key) const {
    const std::string group = plain(stage, item);
    return count_.at(group) > 1 ? group + "." + key.hex() : group;
  }

 private:
  static std::string plain(const std::string& stage, const std::string& item) {
    return stage + "/" + item_label(item);
  }
  std::map<std::string, std::size_t> count_;
};

std::vector<NamedArray> named_arrays(const std::vector<ArtefactPtr>& artefacts) {
  Groups groups;
  for (const ArtefactPtr& artefact : artefacts) groups.add(artefact->recipe.stage, artefact->note.item);
  std::vector<NamedArray> arrays;
  for (const ArtefactPtr& artefact : artefacts) {
    const std::string group = groups.of(artefact->recipe.stage, artefact->note.item, artefact->key);
    for (const PackedArray& array : artefact->arrays) arrays.push_back({group + "/" + array.name, array});
  }
  return arrays;
}

}  // namespace

SegmentRow row_of(const Artefact& artefact) {
  return {.key = artefact.key,
          .content = artefact.content,
          .stage = artefact.recipe.stage,
          .item = artefact.note.item,
          .remark = artefact.note.remark,
          .bytes = salbench::bytes_of(artefact)};
}

SegmentImage segment_image(const std::vector<ArtefactPtr>& artefacts) {
  PlacedImage hdf5 = hdf5_image(named_arrays(artefacts));
  Table table;
  std::vector<Bytes> records;
  auto pieces = hdf5.pieces.cbegin();
  for (const ArtefactPtr& artefact : artefacts) {
    const Bytes& record = records.emplace_back(record_of(*artefact, pieces));
    pieces += std::ssize(artefact->arrays);
    SegmentRow& row = table.rows.emplace_back(row_of(*artefact));
    row.size = record.size();
    row.checksum = checksum(record);
  }
  const std::uint64_t bytes = table_bytes(table, 0).size();
  std::uint64_t at = kTableAt + bytes;
  for (SegmentRow& row : table.rows) row.at = std::exchange(at, at + row.size);
  table.head = user_block(at);
  move_behind(table.head, hdf5.bytes);
  table.body = hdf5.bytes.size();
  table.body_checksum = checksum(hdf5.bytes);

  const Bytes content = table_bytes(table, bytes);
  FieldWriter head;
  head.add_bytes(bytes_of(kMagic));
  head.add(checksum(content));
  head.add_bytes(content);
  for (const Bytes& record : records) head.add_bytes(record);
  head.bytes.resize(table.head);
  return {checksum(content), std::move(head.bytes), std::move(hdf5.bytes)};
}

std::optional<Segment> Segment::open(const std::filesystem::path& path) {
  Segment segment;
  segment.file_ = OpenFile::open(path);
  if (!segment.file_) return {};
  Bytes begin = segment.file_->read(0, kFirstRead);
  if (begin.size() < user_block(0))
    throw InputError(fmt::format("truncated: {} bytes are left", begin.size()));
  if (!std::ranges::equal(bytes_of(kMagic), View(begin).first(kMagic.size())))
    throw InputError("not a file of a cache");
  FieldReader start(View(begin).subspan(kMagic.size()));
  const std::uint64_t sum = start.number();
  segment.head_ = start.number();
  const std::uint64_t bytes = start.number();
  const bool fits = bytes <= segment.file_->size();
  if (fits && kTableAt + bytes > begin.size()) begin = segment.file_->read(0, kTableAt + bytes);
  if (!fits || bytes > begin.size() - kTableAt || checksum(View(begin).subspan(kTableAt, bytes)) != sum)
    throw InputError("checksum mismatch in its table");
  if (const auto name = parse_segment_name(path.filename().native()); !name || name->checksum != sum)
    throw InputError("it is not the file of this name");
  FieldReader in(View(begin).subspan(kTableAt, bytes));
  in.skip(2);  // sizes of head and table, already read
  segment.body_ = in.number();
  segment.body_checksum_ = in.number();
  const std::uint64_t size = segment.file_->size(), expected = segment.head_ + segment.body_;
  if (size != expected)
    throw InputError(
        fmt::format("{}: {} bytes, expected {}", size < expected ? "truncated" : "too long", size, expected));
  segment.rows_.resize(in.count());
  for (SegmentRow& row : segment.rows_) {
    row.key = in.digest();
    row.content = in.digest();
    for (std::uint64_t* number : {&row.bytes, &row.at, &row.size, &row.checksum}) *number = in.number();
    row.stage = in.text();
    row.item = in.text();
    row.remark = in.text();
  }
  return segment;
}

std::optional<Artefact> Segment::read(const SegmentRow& row, Part part) const {
  const auto part_of_file = [&](std::uint64_t at, std::uint64_t bytes) {
    Bytes read = file_->read(at, bytes);
    if (read.size() != bytes) throw InputError("it ends within an array");
    return read;
  };
  const Bytes record = part_of_file(row.at, row.size);
  if (checksum(record) != row.checksum) throw InputError("checksum mismatch in its record");
  FieldReader fields(record);
  Artefact artefact = artefact_in(fields);
  if (artefact.key != row.key || artefact.content != row.content)
    throw InputError("its record is that of another artefact");
  artefact.note.remark = row.remark;
  for (std::uint64_t left = fields.count(); left > 0; --left) {
    ListedArray listed = array_in(fields);
    artefact.arrays.push_back(part == Part::record
                                  ? std::move(listed.array)
                                  : whole_array(std::move(listed), [&](const FilePiece& piece) {
                                      return part_of_file(head_ + piece.at, piece.bytes);
                                    }));
  }
  return artefact;
}

std::string Segment::group(const SegmentRow& row) const {
  Groups groups;
  for (const SegmentRow& other : rows_) groups.add(other.stage, other.item);
  return groups.of(row.stage, row.item, row.key);
}

void Segment::check() const {
  for (const SegmentRow& row : rows_) read(row, Part::record);
  if (checksum(file_->read(head_, body_)) != body_checksum_)
    throw InputError("checksum mismatch in its HDF5 part");
}

std::string damage_in(const std::filesystem::path& file) try {
  if (const auto segment = Segment::open(file)) segment->check();
  return {};
} catch (const InputError& error) {
  return error.what();
}

std::filesystem::path write_segment(const std::filesystem::path& cache, const std::string& label,
                                    const SegmentImage& image) {
  const auto path = cache / segment_folder(label) / SegmentName{label, image.checksum}.text();
  std::error_code error;
  if (!std::filesystem::exists(cache / kScratchFolder, error)) prepare_cache(cache);  // since removed
  make_folder(path.parent_path(), "choose another cache with " + as_option("cache"));
  UnfinishedFile file(cache / kScratchFolder);
  file.append(image.head);
  file.append(image.body);
  file.finish_unsynced(path);
  return path;
}

}  // namespace salbench
