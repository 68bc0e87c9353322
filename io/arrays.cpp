#include "io/arrays.h"

namespace salbench {
namespace {

template <class Pairs>
auto find_named(Pairs& entries, std::string_view name, auto name_of) -> decltype(&*entries.begin()) {
  for (auto& entry : entries)
    if (name_of(entry) == name) return &entry;
  return nullptr;
}

}  // namespace

std::size_t Array::count() const {
  std::size_t product = 1;
  for (const std::size_t extent : shape) product *= extent;
  return product;
}

const Array* find_array(const Arrays& arrays, std::string_view name) {
  return find_named(arrays, name, [](const Array& a) -> std::string_view { return a.name; });
}

const AttributeValue* find_attribute(const Attributes& attributes, std::string_view name) {
  const auto* entry = find_named(attributes, name, [](const auto& a) -> std::string_view { return a.first; });
  return entry == nullptr ? nullptr : &entry->second;
}

}  // namespace salbench
