// The rows of a table as records of fixed size, for formats that store such: fields packed one behind the
// other, numbers in this machine's byte order, text filled up with zero bytes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/table.h"

namespace salbench {

enum class FieldType { text, integer, real };  // in the order of the alternatives of Cell

struct Field {
  std::string name;
  FieldType type = FieldType::text;
  std::size_t size = 1;    // bytes: 8 of a number; of text those of the longest cell, at least 1
  std::size_t offset = 0;  // bytes from the begin of the record
};

struct Records {
  std::vector<Field> fields;
  std::vector<std::byte> bytes;  // n x record_size
};

std::vector<Field> packed(std::vector<Field> fields);       // sets the offsets
std::size_t record_size(const std::vector<Field>& fields);  // bytes; of packed fields

// A column without cells is text. Throws std::logic_error for a column that mixes types.
Records records_from(const Table& table);

}  // namespace salbench
