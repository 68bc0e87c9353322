// SPDX-License-Identifier: GPL-3.0-or-later
// A project without shapes: texts have three words each, words have lengths, and all words are padded to the
// longest of all texts.
#pragma once

#include <algorithm>
#include <atomic>
#include <sstream>
#include <string>
#include <vector>

#include "cache/folder_store.h"
#include "pipeline/engine/binding.h"
#include "pipeline/engine/plan.h"
#include "pipeline/engine/run.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {

template <>
struct ArrayForm<double> {
  static constexpr std::string_view kind = "number";
  static Arrays arrays(double number) { return {{"value", {}, std::vector{number}, "1", "the number"}}; }
  static double read(const Arrays& arrays) { return std::get<std::vector<double>>(arrays[0].values)[0]; }
};
template <>
struct ArrayForm<std::string> {
  static constexpr std::string_view kind = "string";
  static Arrays arrays(const std::string& text) {
    return {{"value", {text.size()}, std::vector<std::uint8_t>(text.begin(), text.end()), "1", "UTF-8"}};
  }
  static std::string read(const Arrays& arrays) {
    const auto& bytes = std::get<std::vector<std::uint8_t>>(arrays[0].values);
    return {bytes.begin(), bytes.end()};
  }
};

inline constexpr Level kTexts = 1, kWords = 2;
inline constexpr std::uint32_t kWordsPerText = 3;

inline Units toy_units(std::size_t texts) {
  std::vector<Family> families;
  for (std::size_t i = 0; i < texts; ++i) families.push_back({kTexts, "text" + std::to_string(i), i});
  return {{{"whole", "whole"}, {"text", "texts"}, {"word", "words", kTexts, kWordsPerText, "number"}},
          families};
}

struct Padding {
  char with = '.';
};

// text -> word -> length -> longest; word, longest -> padded.
inline Project toy_project(const TemporaryFolder& folder, const std::vector<std::string>& texts,
                           Padding padding = {}) {
  const auto files = std::make_shared<std::vector<std::vector<File>>>();
  for (std::size_t i = 0; i < texts.size(); ++i)
    files->push_back({{.name = "text", .place = folder.write(std::to_string(i), texts[i])}});
  RuleTable table;
  const auto text = table.add(
      kTexts, {.stage = "text"}, [](const Files& file) { return file.data[0].text(); }, files_of(files));
  const auto word = table.add(
      kWords, {.stage = "word"},
      [](const std::string& whole, const UnitPlace& place) {
        std::istringstream words(whole);
        std::string nth;
        for (std::uint32_t i = 0; i <= place.index; ++i)
          if (!(words >> nth)) throw InputError("too few words");
        return nth;
      },
      text, kPlace);
  const auto length = table.add(
      kWords, {.stage = "length"}, [](const std::string& s) { return static_cast<double>(s.size()); }, word);
  const auto longest = table.add(
      kWords, {.stage = "longest"},
      [](const Members<double>& lengths) {
        double most = 0;
        lengths.for_each([&](double characters) { most = std::max(most, characters); });
        return most;
      },
      length);
  table.add(
      kWords, {.stage = "padded"},
      [](const std::string& s, double width, const Padding& with) {
        return s + std::string(static_cast<std::size_t>(width) - s.size(), with.with);
      },
      word, longest,
      SectionOf<Padding>{{"padding", "with: x\n", std::string("with: ") + padding.with + "\n"}, padding});
  return {.rules = std::move(table).take(), .units = toy_units(texts.size())};
}

}  // namespace salbench
