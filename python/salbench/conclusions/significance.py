# SPDX-License-Identifier: GPL-3.0-or-later
"""All pairs of models under every metric: significance.csv."""

import pandas

from salbench.conclusions.study import Study
from salbench.conclusions.tables import CI95, DATASET, METRIC, N_SHAPES, SPLIT, N, count, framed, number, text

COLUMNS = (
    DATASET,
    SPLIT,
    METRIC,
    text("model_a", "first model"),
    text("model_b", "second model"),
    N,
    N_SHAPES,
    number("mean_difference", "mean over the units of a - b"),
    *CI95,
    number("t_p", "two-sided p of the paired t-test, for this pair alone"),
    number("t", "mean difference in standard errors"),
    number(
        "t_bound",
        (
            "what |t| must be beyond for the two to differ among all pairs of competitors; empty for"
            " references, for fewer than six units, and if no pair could differ"
        ),
    ),
    number("ci90_low", "90 % interval, lower end: within -+ margin, the two are equivalent at 0.05"),
    number("ci90_high", "upper end"),
    number("d_z", "mean difference over the standard deviation of the differences"),
    number("rank_biserial", "matched-pairs rank-biserial correlation, -1 to 1"),
    number("superiority", "probability that a is higher on a new unit"),
    number("superiority_low", "its 95 % interval (Wilson)"),
    number("superiority_high", "upper end"),
    number("rank_sum_z", "the paper's rank-sum test, over all shapes of each model"),
    number("rank_sum_p", "two-sided p"),
    number("signed_rank", "the smaller sum of ranks"),
    number("signed_rank_p", "two-sided p of the signed-rank test"),
    number("signed_rank_p_holm", "after Holm's correction over the pairs of the data set and metric"),
    count("n_tests", "that many"),
    number(
        "joint95_low",
        (
            "95 % interval of the mean difference, joint for all pairs of competitors; empty for references,"
            " and for fewer than six units"
        ),
    ),
    number("joint95_high", "upper end"),
)


def significance(study: Study) -> pandas.DataFrame:
    """A row per data set, metric and pair of models, references included. Differences are `model_a` minus
    `model_b` for either direction of the metric, paired by unit; `ci95_*` is their interval."""
    return framed(COLUMNS, [dict(study.pairs)], study.in_splits)
