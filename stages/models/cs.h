// SPDX-License-Identifier: GPL-3.0-or-later
// CS, cluster-based point set saliency. A cluster of points is salient if its descriptors differ from those
// of its surroundings, and if similar clusters lie close together. The value of a point is a mean over the
// clusters similar to it.
#pragma once

#include <cstdint>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kCsAbout = {
    .name = "Cluster-based point set saliency",
    .authors = "Tasse, Kosinka, Dodgson",
    .year = "2015",
    .link =
        "https://openaccess.thecvf.com/content_iccv_2015/html/"
        "Tasse_Cluster-Based_Point_Set_ICCV_2015_paper.html",
    .key = "tasse2015",
    .values = ": clusters that are unlike their surroundings; 0 to 1",
    .by_default = true,
};

struct CsOptions {
  double radius = 0.02;
  std::int32_t clusters = 500;
  std::int32_t rounds = 30;
  double descriptor_weight = 2;
  bool repair = true;
  double distribution_weight = 0.5;
  std::int32_t sample = 262144;

  static CsOptions text();  // the paper's table of parameters: 100 clusters

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("radius", self.radius,
          {"support radius, grown until it holds 6 other points on average", "R", above(0)});
    visit("clusters", self.clusters,
          {"clusters aimed at; the grid of seeds makes somewhat fewer or more", "clusters", at_least(1)});
    visit("rounds", self.rounds, {"limit of the rounds of k-means", "rounds", at_least(0)});
    visit("descriptor_weight", self.descriptor_weight,
          {"of the descriptors' distance in k-means, relative to the distance in space", {}, at_least(0)});
    visit("repair", self.repair,
          {"move voxels that k-means has cut off from their cluster to a neighbouring one"});
    visit("distribution_weight", self.distribution_weight,
          {"of the clusters' distribution in space; the rest is that of their uniqueness", "fraction",
           between(0, 1)});
    visit("sample", self.sample,
          {"a larger shape's neighbours are looked for in an even sample", "points", at_least(1000)});
  }
};

// In [0, 1]. Computes its own descriptors. If there are no more points than intended clusters, each point is
// a cluster. The map is constant if all points coincide, or if nothing distinguishes the clusters. Time and
// memory O(n) beyond the sample. Throws InputError for a shape without points or with a coordinate or normal
// that is not finite, and like grown_support_radius. [tasse2015] [tasse2016]
ScalarField cs_saliency(Points points, const Normals& normals, const CsOptions& options);

}  // namespace salbench
