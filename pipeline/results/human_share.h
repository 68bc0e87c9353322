// SPDX-License-Identifier: GPL-3.0-or-later
// Scores as a share of what people reach.
#pragma once

#include "io/table.h"
#include "pipeline/results/conclusions.h"

namespace salbench {

// dataset, metric, model, n (units), n_shapes, mean, mean_rs, mean_hs, share, ci95_low, ci95_high, remark:
// how far each competitor goes from chance (RS) to human performance (HS), over the shapes that all
// competitors, RS and HS have a score for. The share is empty where HS is not better than RS by the paired
// t-test at 0.05, or one of them is missing; `remark` says why a cell is.
Table human_share_table(const Conclusions& conclusions);

}  // namespace salbench
