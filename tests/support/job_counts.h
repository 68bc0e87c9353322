// How many jobs a first run has, counted in the catalog: a new model or stage changes no number in a test.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "pipeline/catalog.h"
#include "stages/scan/scan.h"
#include "tests/support/toy_data.h"

namespace salbench {

// Of so many meshes, all of them with ground truth, and their scans.
class JobCounts {
 public:
  JobCounts(const Config& config, std::size_t meshes) : catalog_(make_catalog(config)), meshes_(meshes) {}
  explicit JobCounts(const std::string& yaml = kToyConfig, std::size_t meshes = 2)
      : JobCounts(toy_config(yaml), meshes) {}

  std::size_t meshes() const { return meshes_; }
  std::size_t scans() const { return catalog_.scan.empty() ? 0 : meshes_ * kViews; }
  std::size_t shapes() const { return meshes() + scans(); }

  template <class Predicate>  // of a Stage
  std::size_t where(const Predicate& wanted) const {
    const auto count = [&](const Chain& chain) {
      return static_cast<std::size_t>(std::count_if(chain.begin(), chain.end(), wanted));
    };
    return meshes() * count(catalog_.mesh) + scans() * count(catalog_.scan);
  }

  // A mean is taken over the meshes and over the scans, whichever have the stage that is averaged.
  template <class Predicate>  // of a MeanHistogram
  std::size_t means_where(const Predicate& wanted) const {
    std::size_t sum = 0;
    for (const MeanHistogram& mean : catalog_.means)
      if (wanted(mean))
        sum += (has_stage(catalog_.mesh, mean.of_mesh) ? 1U : 0U) +
               (has_stage(catalog_.scan, mean.of_scan) ? 1U : 0U);
    return sum;
  }

  std::size_t stages() const {
    return where([](const Stage&) { return true; });
  }
  std::size_t means() const {
    return means_where([](const MeanHistogram&) { return true; });
  }
  std::size_t all() const { return stages() + means(); }

  // What can be had without the rest of the data set: no matching, and no means.
  std::size_t before_reference() const {
    return where([](const Stage& stage) { return !stage.after_reference; });
  }

  // Of one stage or mean. A name that the catalog does not have is a mistake of the test.
  std::size_t of(std::string_view name) const {
    const auto is_it = [&](const auto& row) { return row.name == name; };
    return expect_some(where(is_it) + means_where(is_it), name);
  }

  // Map, matched map, scores and mean histogram, as far as the model has them.
  std::size_t of_model(std::string_view model) const {
    const auto is_of_it = [end = "." + std::string(model)](const auto& row) {
      return row.name.ends_with(end);
    };
    return expect_some(where(is_of_it) + means_where(is_of_it), model);
  }

  // Of one layout, such as "scores"; for scores, the rows of results.csv.
  std::size_t of_kind(std::string_view kind) const {
    return expect_some(where([&](const Stage& stage) { return stage.kind == kind; }), kind);
  }

 private:
  static std::size_t expect_some(std::size_t count, std::string_view name) {
    if (count == 0) throw std::out_of_range("no job of " + std::string(name));
    return count;
  }

  Catalog catalog_;
  std::size_t meshes_;
};

}  // namespace salbench
