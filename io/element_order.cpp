// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/element_order.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

namespace salbench {
namespace {

// Lower-case letters and digits of a name: "Vertex_ID" is "vertexid".
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') plain += static_cast<char>(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) plain += c;
  }
  return plain;
}

template <std::size_t n>
bool is_one_of(const std::array<std::string_view, n>& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

// How surely a name is that of a column of numbers of elements.
enum class NumberingName { no, unnamed, any_index, of_elements };

NumberingName numbering_name(std::string_view name, bool is_first, const Elements& elements) {
  constexpr std::array<std::string_view, 5> kPoints = {"vertex", "vert", "vtx", "point", "node"};
  constexpr std::array<std::string_view, 4> kFaces = {"face", "facet", "triangle", "polygon"};
  constexpr std::array<std::string_view, 4> kIndices = {"index", "idx", "id", "nr"};
  constexpr std::array<std::string_view, 2> kMoreEndings = {"number", "no"};
  const std::string plain = plain_name(name);
  if (name.empty() || plain == "unnamed0") return is_first ? NumberingName::unnamed : NumberingName::no;
  if (is_one_of(kIndices, plain)) return NumberingName::any_index;
  const auto names_elements = [&](std::string_view word) {
    return elements.one == "face" ? is_one_of(kFaces, word) : is_one_of(kPoints, word);
  };
  const auto names_elements_before = [&](std::string_view ending) {
    return plain.ends_with(ending) &&
           names_elements(std::string_view(plain).substr(0, plain.size() - ending.size()));
  };
  return names_elements(plain) || std::ranges::any_of(kIndices, names_elements_before) ||
                 std::ranges::any_of(kMoreEndings, names_elements_before)
             ? NumberingName::of_elements
             : NumberingName::no;
}

}  // namespace

std::optional<std::size_t> numbering_column(const TextScanner& in, std::span<const std::string_view> header,
                                            const Elements& elements, std::span<const std::size_t> taken) {
  std::vector<NumberingName> names(header.size(), NumberingName::no);
  for (std::size_t place = 0; place < header.size(); ++place)
    if (std::ranges::find(taken, place) == taken.end())
      names[place] = numbering_name(header[place], place == 0, elements);
  const auto best = std::ranges::max_element(names);
  if (best == names.end() || *best == NumberingName::no) return {};
  const auto found = static_cast<std::size_t>(best - names.begin());
  if (const auto twin = std::find(best + 1, names.end(), *best); twin != names.end())
    in.fail(fmt::format("columns {} and {} both number the {}: rename one", in_quotes(header[found]),
                        in_quotes(header[static_cast<std::size_t>(twin - names.begin())]), elements.plural));
  return found;
}

std::vector<std::size_t> rows_in_order(const TextScanner& in, std::string_view column,
                                       std::span<const double> numbers, std::span<const std::size_t> lines,
                                       const Elements& elements) {
  if (numbers.empty()) return {};
  const std::size_t n = numbers.size();
  const double base = *std::ranges::min_element(numbers) == 0 ? 0 : 1;
  std::vector<std::size_t> row_of(n, n);
  for (std::size_t row = 0; row < n; ++row) {
    const double place = numbers[row] - base;
    const bool is_place = place >= 0 && place < static_cast<double>(n) &&
                          place == static_cast<double>(static_cast<std::size_t>(place));
    if (!is_place || row_of[static_cast<std::size_t>(place)] != n)
      in.fail_at(
          lines[row],
          fmt::format("column {} has {}{}; it numbers the {}, expected each number from 0 to {}, or from 1 "
                      "to {}, once: correct it, or rename it if it is something else",
                      in_quotes(column), numbers[row], is_place ? " a second time" : "", elements.plural,
                      n - 1, n));
    row_of[static_cast<std::size_t>(place)] = row;
  }
  return row_of;
}

}  // namespace salbench
