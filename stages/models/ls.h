// SPDX-License-Identifier: GPL-3.0-or-later
// LS, saliency of large point sets. A point is salient if its surroundings differ, at two scales, even from
// the most similar surroundings, or if it lies near such a point.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/descriptors/fpfh.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kLsAbout = {
    .name = "Saliency of large point sets",
    .authors = "Shtrom, Leifman, Tal",
    .year = "2013",
    .link =
        "https://openaccess.thecvf.com/content_iccv_2013/html/"
        "Shtrom_Saliency_Detection_in_2013_ICCV_paper.html",
    .key = "shtrom2013",
    .values = ": what differs at two scales from all that resembles it, or is near to it; >= 0",
    .by_default = true,
};

// Defaults are those of the benchmark's authors. Lengths are in units of R, the largest distance to the
// centroid. The number of points in a share is rounded down, but at least one point is selected and one is a
// focus.
struct LsOptions {
  double selected_share = 0.05;
  double selected_share_of_scans = 0.1;
  double foci_share = 0.2;
  double foci_sigma = 0.05;
  double high_share = 0.1;
  double high_radius = 0.1;
  FpfhWeighting high_weighting = FpfhWeighting::published;
  double high_weight = 0.5;
  std::int32_t sample = 32768;

  LsOptions of_meshes() const;
  LsOptions of_scans() const;
  static LsOptions text();  // as the paper describes it; the shared descriptors then use its grown radius

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("selected_share", self.selected_share,
          {"points compared with, the most similar ones; 1: all", "fraction of the points", between(0, 1)});
    visit("selected_share_of_scans", self.selected_share_of_scans,
          {"the same on scans; 0: as on meshes", "fraction of the points", between(0, 1), "0"});
    visit("foci_share", self.foci_share,
          {"points of largest low-level distinctness: the foci of attention", "fraction of the points",
           between(0, 1)});
    visit("foci_sigma", self.foci_sigma,
          {"reach of a focus: standard deviation of its Gaussian", "R", above(0)});
    visit("high_share", self.high_share,
          {"points described at the high level, those of largest distinctness", "fraction of the points",
           between(0, 1)});
    visit("high_radius", self.high_radius, {"support radius of the high level", "R", above(0)});
    visit("high_weighting", self.high_weighting, {"how the neighbours' histograms are combined there"});
    visit("high_weight", self.high_weight,
          {"of high-level distinctness, relative to the low level", {}, at_least(0)});
    visit("sample", self.sample,
          {"a larger shape is compared with, and described by, an even sample", "points", at_least(1000)});
  }
};

// D_low + A + high_weight D_high, >= 0. `fpfh` (n x 33) are the descriptors of the low level; those of the
// high level are computed here from points and normals. Time and memory O(n) beyond the sample; terms of the
// sums in single precision. If the selected share is less than two points, each point is compared only with
// itself, and all values are 0. Throws InputError for a shape without points, without extent, or with a
// coordinate, normal or descriptor that is not finite, and like require_few_neighbours for the high radius.
// [shtrom2013] [tasse2016]
ScalarField ls_saliency(Points points, const Normals& normals, const Descriptors& fpfh,
                        const LsOptions& options);

}  // namespace salbench
