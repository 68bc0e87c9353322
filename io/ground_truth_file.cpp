#include "io/ground_truth_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/file.h"
#include "io/text_scanner.h"

namespace salbench {
namespace {

void expect_end_of_line(TextScanner& in) {
  if (!in.peek_word().empty()) in.fail("the line has more than one value");
}

}  // namespace

ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices) {
  TextScanner in(text, name);
  ScalarField values;
  values.reserve(n_vertices);
  while (in.next_filled_line()) {
    values.push_back(in.number());
    expect_end_of_line(in);
  }
  if (values.size() != n_vertices)
    in.fail(fmt::format("the file has {} values, the mesh {} vertices: they do not belong together",
                        values.size(), n_vertices));
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

ScalarField read_saliency(const std::filesystem::path& path, std::size_t n_vertices) {
  return parse_saliency(read_file(path), path.string(), n_vertices);
}

std::vector<std::int32_t> read_picks(const std::filesystem::path& path, std::size_t n_vertices) {
  return parse_picks(read_file(path), path.string(), n_vertices);
}

GroundTruth read_ground_truth(const DatasetItem& item, std::size_t n_vertices) {
  GroundTruth truth;
  if (!item.saliency.empty()) truth.saliency = read_saliency(item.saliency, n_vertices);
  for (const auto& path : item.picks) truth.picks.push_back(read_picks(path, n_vertices));
  if (std::all_of(truth.picks.begin(), truth.picks.end(), [](const auto& picks) { return picks.empty(); }))
    truth.picks.clear();
  return truth;
}

}  // namespace salbench
