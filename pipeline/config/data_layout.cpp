// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/data_layout.h"

#include <algorithm>
#include <cmath>
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

Vec3 read_camera(const Section& section, std::string_view key, const Words& words, bool at_infinity) {
  Vec3 place;
  bool numbers = words.size() == 3;
  for (int axis = 0; numbers && axis < 3; ++axis)
    numbers = parse_option(words[static_cast<std::size_t>(axis)], place[axis]);
  if (!numbers)
    section.fail(key, "is not three finite numbers [x, y, z], a mapping of views to such, or a CSV file");
  if (const std::string_view wrong = wrong_with_camera(place, at_infinity); !wrong.empty())
    section.fail(key, fmt::format("is no place to look from: {}", wrong));
  return place;
}

// [x, y, z], or these by view, or a file.
Cameras read_cameras(const Section& section, std::string_view key, bool at_infinity) {
  Cameras cameras{.at_infinity = at_infinity, .where = section.where(key)};
  if (section.has_mapping(key)) {
    const Section views = section.child(key);
    for (const std::string& view : views.keys())
      cameras.by_view.emplace(view, read_camera(views, view, views.words(view), at_infinity));
    if (cameras.empty()) section.fail(key, "names no view");
    return cameras;
  }
  const Words words = section.words(key);
  if (words.size() == 1)
    cameras.file = words[0];
  else
    cameras.by_view.emplace("", read_camera(section, key, words, at_infinity));
  return cameras;
}

Cameras read_cameras(const Section& section) {
  constexpr std::string_view kPlace = "visible_from", kDirection = "visible_from_direction";
  if (section.has(kPlace) && section.has(kDirection))
    section.fail(kDirection, "is there beside visible_from: expected one of them");
  if (section.has(kPlace)) return read_cameras(section, kPlace, false);
  return section.has(kDirection) ? read_cameras(section, kDirection, true) : Cameras{};
}

TruthPlace read_truth(const Section& section) {
  section.reject_unknown({"saliency", "picks", "mask", "visible_from", "visible_from_direction"});
  TruthPlace truth;
  truth.saliency = read_pattern(section, "saliency", [](std::string_view text) {
    return wrong_with_truth_pattern(text, {"{view}", "{viewer}"});
  });
  truth.picks = read_pattern(section, "picks", [](std::string_view text) {
    return wrong_with_truth_pattern(text, {"{participant}"});
  });
  truth.mask = read_pattern(section, "mask", [&](std::string_view text) {
    const std::string wrong = wrong_with_truth_pattern(text, {"{view}", "{viewer}"});
    if (!wrong.empty() || one_file_per_item(FilePattern{std::string(text)})) return wrong;
    const bool same = !one_file_per_item(truth.saliency) &&
                      has_viewers(FilePattern{std::string(text)}) == has_viewers(truth.saliency);
    return same ? "" : std::string("must have the {view} or {viewer} that `saliency` has, or none");
  });
  if (!truth.mask.empty() && truth.saliency.empty())
    section.fail("mask", "is there without saliency: expected a pattern of the files that it masks");
  truth.cameras = read_cameras(section);
  return truth;
}

// `units: mm`, or `scale: 0.001`: lengths are shown in metres, or in whatever the scale makes of them.
LengthUnit read_unit(const Section& root) {
  static const std::map<std::string, double, std::less<>> kMetres = {
      {"m", 1}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
  if (root.has("units") && root.has("scale"))
    root.fail("scale", "is there beside units: expected one of them");
  LengthUnit unit;
  if (const auto name = root.text("units")) {
    const auto found = kMetres.find(*name);
    if (found == kMetres.end())
      root.fail("units",
                fmt::format("is '{}', expected one of m, dm, cm, mm, um, in, ft; or use scale", *name));
    unit = {root.where("units"), found->second};
  } else if (root.has("scale")) {
    unit.where = root.where("scale");
    root.read_value("scale", unit.scale);
    if (!(unit.scale > 0)) root.fail("scale", fmt::format("must be a number above 0, not {}", unit.scale));
  }
  return unit;
}

// Picks, or a rule in place of them.
void check_positives(const Section& root, const Layout& layout) {
  if (positive_rule(layout.format.values).by == PositiveRule::By::picks) return;
  const bool picked =
      !layout.format.columns.flag.empty() || std::ranges::any_of(layout.places, [](const Place& place) {
        return std::ranges::any_of(place.truth, [](const TruthPlace& truth) { return !truth.picks.empty(); });
      });
  if (picked)
    root.child("values").fail("positives", fmt::format("is '{}', but there are picks: leave one of them out",
                                                       layout.format.values.positives));
}

Place read_place(const Section& section) {
  section.reject_unknown({"meshes", "needs", "root_is", "truth", "views"});
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
  section.read_value("views", place.views);
  if (place.views == Views::scored &&
      !std::ranges::all_of(place.truth, [](const TruthPlace& truth) { return has_views(truth.saliency); }))
    section.fail("views", "is 'scored', but saliency has no {view} in its pattern");
  return place;
}

// "80%" or "0.8".
double read_share(const Section& shares, const std::string& split) {
  std::string text = shares.text(split).value_or("");
  const bool percent = text.ends_with('%');
  if (percent) text.pop_back();
  double share = 0;
  if (!parse_option(text, share) || !(share > 0 && share <= (percent ? 100 : 1)))
    shares.fail(split, "is not a share of the lines, such as 80% or 0.8");
  return percent ? share / 100 : share;
}

DataSplits read_splits(const Section& root) {
  DataSplits splits;
  if (!root.has("splits")) return splits;
  const Section section = root.child("splits");
  splits.where = root.where("splits");
  section.reject_unknown({"file", "item", "split", "list", "shares", "items"});
  if ((section.has("file") ? 1 : 0) + (section.has("list") ? 1 : 0) + (section.has("items") ? 1 : 0) != 1)
    root.fail("splits", "must have one of file (a CSV file), list (with shares), or items");
  section.read_value("file", splits.table);
  section.read_value("item", splits.item);
  section.read_value("split", splits.split);
  section.read_value("list", splits.list);
  const Section shares = section.child("shares"), items = section.child("items");
  double sum = 0;
  for (const std::string& name : shares.keys()) {
    splits.shares.emplace_back(name, read_share(shares, name));
    sum += splits.shares.back().second;
  }
  constexpr double kRounding = 1e-9;
  if (splits.list.empty() != splits.shares.empty() || (!splits.list.empty() && std::abs(sum - 1) > kRounding))
    section.fail("shares", "must name each split's share of the lines of `list`, which sum to 1");
  for (const std::string& name : items.keys())
    splits.named.push_back({name, items.words(name), items.where(name)});
  if (splits.empty()) section.fail("items", "names no split");
  return splits;
}

Section section_of(const NamedYaml& description) {
  return Section::from_text(std::string(description.yaml),
                            fmt::format("configs/datasets/{}{}", description.name, kExtension));
}

// Those whose key `automatic` gives them a place among the layouts to try.
std::vector<Layout> automatic_layouts() {
  std::multimap<std::int32_t, Layout> tried;
  for (const NamedYaml& description : descriptions()) {
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
  for (const NamedYaml& description : descriptions()) names.push_back(description.name);
  return names;
}

bool is_layout(std::string_view text) {
  return std::ranges::count(layout_names(), text) > 0 ||
         (text.size() > kExtension.size() && text.ends_with(kExtension));
}

std::vector<Layout> layouts_of(const std::string& layout) {
  if (layout == kAutomaticLayout) return automatic_layouts();
  for (const NamedYaml& description : descriptions())
    if (description.name == layout) return {read_layout(section_of(description), layout)};
  return {read_layout(Section::from_file(layout), std::filesystem::path(layout).stem())};
}

Layout read_layout(const Section& root, const std::string& name) {
  root.reject_unknown({"automatic", "domain", "classes", "ground_truth", "places", "values", "indices",
                       "columns", "splits", "units", "scale", "index", "licence"});
  Layout layout;
  layout.name = name;
  root.read_value("domain", layout.domain);
  root.read_value("classes", layout.classes);
  Truth truth = Truth::required;
  root.read_value("ground_truth", truth);
  layout.needs_truth = truth == Truth::required;
  root.child("values").read(layout.format.values);
  root.child("indices").read(layout.format.indices);
  root.child("columns").read(layout.format.columns);
  layout.splits = read_splits(root);
  for (const Section& place : root.list("places")) layout.places.push_back(read_place(place));
  root.read_value("licence", layout.licence);
  root.read_value("index", layout.index);
  if (!layout.index.empty() && !layout.places.empty())
    root.fail("index", "is there beside `places`: a set is in the one form or in files of its own");
  if (layout.places.empty() && layout.index.empty())
    root.fail("places", "is missing; expected a list of places with meshes");
  layout.unit = read_unit(root);
  check_positives(root, layout);
  return layout;
}

}  // namespace salbench
