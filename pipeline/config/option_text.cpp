// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/option_text.h"

#include <numeric>
#include <sstream>
#include <utility>

namespace salbench {
namespace {

constexpr std::size_t kMaxWord = 100;  // longest word that is compared with the known ones

// Damerau-Levenshtein distance: letters inserted, removed, replaced, or swapped with the next one.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] == b[j] ? 0 : 1), row[j] + 1, last[j + 1] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string in_lower_case(std::string_view word) {
  std::string lower(word);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known,
                         std::string_view otherwise) {
  if (word.size() > kMaxWord) return std::string(otherwise);
  std::string_view nearest;
  // Twice the distance, plus one if the case differs. No match beyond half of the letters.
  std::size_t best = word.size() + 1;
  for (const std::string_view candidate : known) {
    const std::size_t letters = edit_distance(in_lower_case(word), in_lower_case(candidate));
    if (letters >= std::max(word.size(), candidate.size())) continue;
    const std::size_t distance = 2 * letters + (edit_distance(word, candidate) > letters ? 1 : 0);
    if (distance >= best) continue;
    best = distance;
    nearest = candidate;
  }
  return nearest.empty() ? std::string(otherwise) : fmt::format("did you mean '{}'?", nearest);
}

std::string yaml_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f)
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      result += c;
  }
  return result + '"';
}

std::vector<std::string> lines_in(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string indented(const std::string& lines, std::string_view by) {
  std::string result;
  for (const std::string& line : lines_in(lines)) result += fmt::format("{}{}\n", by, line);
  return result;
}

std::string yaml_mapping(const YamlFields& fields) {
  std::string yaml;
  for (const auto& [key, value] : fields)
    if (!value.empty()) yaml += fmt::format("{}{}: {}", yaml.empty() ? "" : ", ", key, value);
  return "{" + yaml + "}";
}

}  // namespace salbench
