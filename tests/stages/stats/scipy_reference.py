# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference values for scipy_test.cpp.

Reads lines "operation | sample | sample ..." (blank-separated numbers) and writes one line of numbers for each.
"""

import sys

import numpy as np
from scipy import special, stats


def critical_t(freedom, confidence):
    """By the incomplete beta function: stats.t.ppf has only nine digits in SciPy 1.10."""
    beta = special.betaincinv(freedom / 2, 0.5, 1 - confidence)
    return np.sqrt(freedom * (1 - beta) / beta)


def student(x, confidence):
    """Half of the interval of the mean."""
    return critical_t(len(x) - 1, confidence) * stats.sem(x)


def summary(x):
    half_width = student(x, 0.95)
    return np.mean(x), np.std(x, ddof=1), np.mean(x) - half_width, np.mean(x) + half_width


def signed_rank(x, y):
    difference = x - y
    sizes = np.abs(difference)
    # SciPy before 1.11 takes the exact distribution for tied differences too, where it does not hold.
    exact = len(x) <= 50 and len(np.unique(sizes)) == len(sizes) and sizes.min() > 0
    result = stats.wilcoxon(x, y, zero_method="wilcox", correction=False, method="exact" if exact else "approx")
    return (*result, float(exact))


def paired(a, b):
    difference = a - b
    n = len(difference)
    t = stats.ttest_rel(a, b)
    half = student(difference, 0.95)
    ranks = stats.rankdata(np.abs(difference[difference != 0]))
    signs = np.sign(difference[difference != 0])
    wins = np.mean(difference > 0) + np.mean(difference == 0) / 2
    z2 = special.ndtri(0.975) ** 2
    root = np.sqrt(z2 * wins * (1 - wins) / n + z2 ** 2 / (4 * n ** 2))
    return (difference.mean(), difference.mean() - half, difference.mean() + half, t.pvalue,
            difference.mean() / difference.std(ddof=1), (ranks * signs).sum() / ranks.sum(), wins,
            (wins + z2 / (2 * n) - root) / (1 + z2 / n), (wins + z2 / (2 * n) + root) / (1 + z2 / n))


def equivalence(difference, margin):
    below = stats.ttest_1samp(difference, -margin[0], alternative="greater")
    above = stats.ttest_1samp(difference, margin[0], alternative="less")
    half = student(difference, 0.9)
    return max(below.pvalue, above.pvalue), difference.mean() - half, difference.mean() + half


def power(parameters):
    effect, n = parameters
    critical, shift = critical_t(n - 1, 0.95), effect * np.sqrt(n)
    # The lower tail by its mirror image: for some shifts stats.nct.cdf is NaN there in SciPy 1.15.
    return [stats.nct.sf(critical, n - 1, shift) + stats.nct.sf(critical, n - 1, -shift)]


def holm(p):
    """By definition: every hypothesis with a p-value up to one's own, times the number that are not smaller."""
    steps = np.array([min(1.0, np.sum(p >= q) * q) for q in p])
    return [steps[p <= q].max() for q in p]


def kolmogorov_smirnov(a, b):
    bins = np.arange(len(a))
    samples = (np.repeat(bins, counts.astype(int)) for counts in (a, b))
    return [stats.ks_2samp(*samples, method="asymp").statistic]


OPERATIONS = {
    "summary": summary,
    "quantile": lambda x, q: np.quantile(x, q),
    "rank_sum": lambda x, y: tuple(stats.ranksums(x, y)),
    "rank_sum_corrected": lambda x, y: tuple(
        stats.mannwhitneyu(x, y, use_continuity=False, alternative="two-sided", method="asymptotic")
    ),
    "signed_rank": signed_rank,
    "holm": holm,
    "paired": paired,
    "equivalence": equivalence,
    "power": power,
    "kendall": lambda x, y: [stats.kendalltau(x, y)[0]],
    "pearson": lambda x, y: [stats.pearsonr(x, y)[0]],
    "spearman": lambda x, y: [stats.spearmanr(x, y)[0]],
    "kolmogorov_smirnov": kolmogorov_smirnov,
}


def main(cases, results):
    with open(cases) as source, open(results, "w") as target:
        for line in source:
            operation, *samples = line.split("|")
            values = OPERATIONS[operation.strip()](*(np.array(s.split(), dtype=float) for s in samples))
            print(*(repr(float(v)) for v in values), file=target)


if __name__ == "__main__":
    main(*sys.argv[1:])
