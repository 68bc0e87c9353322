#include "io/records.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace salbench {
namespace {

Field field_of(const Table& table, std::size_t column) {
  Field field{table.columns[column]};
  for (const auto& row : table.rows) {
    const Cell& cell = row.at(column);
    if (cell.index() != table.rows.front().at(column).index())
      throw std::logic_error(fmt::format("the column {} mixes types", field.name));
    field.type = static_cast<FieldType>(cell.index());
    const auto* text = std::get_if<std::string>(&cell);
    field.size = std::max(field.size, text != nullptr ? text->size() : sizeof(double));
  }
  return field;
}

void put(std::byte* place, const std::string& text) { std::memcpy(place, text.data(), text.size()); }
template <class Number>
void put(std::byte* place, Number number) {
  std::memcpy(place, &number, sizeof number);
}

}  // namespace

std::vector<Field> packed(std::vector<Field> fields) {
  std::size_t offset = 0;
  for (Field& field : fields) field.offset = std::exchange(offset, offset + field.size);
  return fields;
}

std::size_t record_size(const std::vector<Field>& fields) {
  return fields.empty() ? 0 : fields.back().offset + fields.back().size;
}

Records records_from(const Table& table) {
  std::vector<Field> fields;
  for (std::size_t c = 0; c < table.columns.size(); ++c) fields.push_back(field_of(table, c));
  Records records{packed(std::move(fields)), {}};
  const std::size_t size = record_size(records.fields);
  records.bytes.resize(table.rows.size() * size);
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      std::byte* place = records.bytes.data() + r * size + records.fields[c].offset;
      std::visit([place](const auto& cell) { put(place, cell); }, table.rows[r][c]);
    }
  return records;
}

}  // namespace salbench
