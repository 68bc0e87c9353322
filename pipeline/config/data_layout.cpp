// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/data_layout.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

namespace salbench {

enum class Truth { required, optional };
template <>
struct EnumNames<Truth> {
  static constexpr std::array<std::string_view, 2> names = {"required", "optional"};
};

namespace {

constexpr std::string_view kExtension = ".yaml";

// A pattern of a place; `wrong` says what is wrong with one.
template <class Wrong>
FilePattern read_pattern(const Section& section, std::string_view key, const Wrong& wrong) {
  const auto text = section.text(key);
  if (!text) return {};
  if (const std::string what = wrong(*text); !what.empty())
    section.fail(key, fmt::format("'{}' {}", *text, what));
  return {*text, section.where(key)};
}

TruthPlace read_truth(const Section& section) {
  section.reject_unknown({"saliency", "picks"});
  TruthPlace truth;
  truth.saliency = read_pattern(section, "saliency", [](std::string_view text) {
    return wrong_with_truth_pattern(text, {"{view}", "{viewer}"});
  });
  truth.picks = read_pattern(section, "picks", [](std::string_view text) {
    return wrong_with_truth_pattern(text, {"{participant}"});
  });
  return truth;
}

Place read_place(const Section& section) {
  section.reject_unknown({"meshes", "needs", "root_is", "truth"});
  Place place;
  place.meshes = read_pattern(section, "meshes", wrong_with_mesh_pattern);
  if (place.meshes.empty()) section.fail("meshes", "is missing; expected a pattern such as Meshes/*");
  section.read_value("needs", place.needs);
  section.read_value("root_is", place.root_is);
  for (const Section& truth : section.list("truth")) {
    place.truth.push_back(read_truth(truth));
    if (place.truth.back().saliency.empty() && place.truth.back().picks.empty())
      section.fail("truth", "names neither saliency nor picks");
  }
  return place;
}

Section section_of(const Description& description) {
  return Section::from_text(std::string(description.yaml),
                            fmt::format("configs/datasets/{}{}", description.name, kExtension));
}

// Those whose key `automatic` gives them a place among the layouts to try.
std::vector<Layout> automatic_layouts() {
  std::multimap<std::int32_t, Layout> tried;
  for (const Description& description : descriptions()) {
    const Section root = section_of(description);
    std::int32_t place = 0;
    root.read_value("automatic", place);
    if (place > 0) tried.emplace(place, read_layout(root, std::string(description.name)));
  }
  std::vector<Layout> layouts;
  for (auto& [place, layout] : tried) layouts.push_back(std::move(layout));
  return layouts;
}

}  // namespace

std::vector<std::string_view> layout_names() {
  std::vector<std::string_view> names = {kAutomaticLayout};
  for (const Description& description : descriptions()) names.push_back(description.name);
  return names;
}

bool is_layout(std::string_view text) {
  return std::ranges::count(layout_names(), text) > 0 ||
         (text.size() > kExtension.size() && text.ends_with(kExtension));
}

std::vector<Layout> layouts_of(const std::string& layout) {
  if (layout == kAutomaticLayout) return automatic_layouts();
  for (const Description& description : descriptions())
    if (description.name == layout) return {read_layout(section_of(description), layout)};
  return {read_layout(Section::from_file(layout), std::filesystem::path(layout).stem())};
}

Layout read_layout(const Section& root, const std::string& name) {
  root.reject_unknown({"automatic", "domain", "classes", "ground_truth", "places", "values", "indices"});
  Layout layout;
  layout.name = name;
  root.read_value("domain", layout.domain);
  root.read_value("classes", layout.classes);
  Truth truth = Truth::required;
  root.read_value("ground_truth", truth);
  layout.needs_truth = truth == Truth::required;
  root.child("values").read(layout.format.values);
  root.child("indices").read(layout.format.indices);
  for (const Section& place : root.list("places")) layout.places.push_back(read_place(place));
  if (layout.places.empty()) root.fail("places", "is missing; expected a list of places with meshes");
  return layout;
}

}  // namespace salbench
