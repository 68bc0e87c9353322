// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ground_truth_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/text_scanner.h"
#include "stages/core/check.h"

namespace salbench {
namespace {

void expect_end_of_line(TextScanner& in) {
  if (!in.peek_word().empty()) in.fail("the line has more than one value");
}

ScalarField all_values(TextScanner& in) {
  ScalarField values;
  while (in.next_filled_line()) {
    values.push_back(in.number());
    expect_end_of_line(in);
  }
  return values;
}

}  // namespace

ScalarField parse_values(std::string_view text, std::string_view name) {
  TextScanner in(text, name);
  return all_values(in);
}

ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices) {
  TextScanner in(text, name);
  ScalarField values = all_values(in);
  if (values.size() != n_vertices)
    in.fail(fmt::format("the file has {} values, but the mesh has {} vertices", values.size(), n_vertices));
  return values;
}

std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, std::size_t n_vertices) {
  TextScanner in(text, name);
  std::vector<std::int32_t> picks;
  while (in.next_filled_line()) {
    const std::int64_t vertex = in.integer();
    if (vertex < 0 || vertex >= static_cast<std::int64_t>(n_vertices))
      in.fail(fmt::format("vertex {} is out of range: the mesh has {} vertices, numbered from 0", vertex,
                          n_vertices));
    picks.push_back(static_cast<std::int32_t>(vertex));
    expect_end_of_line(in);
  }
  return picks;
}

GroundTruth parse_ground_truth(const DatasetItem& item, std::span<const std::string_view> texts,
                               std::size_t n_vertices) {
  const bool has_saliency = !item.saliency.empty();
  CHECK_EQ(texts.size(), item.picks.size() + (has_saliency ? 1 : 0));
  GroundTruth truth;
  if (has_saliency) truth.saliency = parse_saliency(texts.front(), item.saliency.string(), n_vertices);
  for (std::size_t k = 0; k < item.picks.size(); ++k)
    truth.picks.push_back(
        parse_picks(texts[texts.size() - item.picks.size() + k], item.picks[k].string(), n_vertices));
  if (std::all_of(truth.picks.begin(), truth.picks.end(), [](const auto& picks) { return picks.empty(); }))
    truth.picks.clear();
  return truth;
}

}  // namespace salbench
