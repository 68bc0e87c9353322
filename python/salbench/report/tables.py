# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's tables of scores: means, classes, pairwise tests, parameters."""

from collections.abc import Mapping, Sequence
from typing import Any

from salbench.pages.blocks import Block, Cell, Fold, Missing, Note, Table, cell, first_of, interval, p_value, spread
from salbench.pages.names import DATASETS, KIND_NAMES, several, spoken
from salbench.report import latex, paper, statistics, units
from salbench.report.metrics import Metric
from salbench.report.results import Frame, Row, flatten
from salbench.report.units import count_cell
from salbench.report.workshop import Workshop

LEVEL = 0.05  # of the tests


def signed(value: float, digits: int = 3, **more: Any) -> Cell:
    if value != value:
        return cell(value, digits, **more)
    return Cell(f"{value:+.{digits}f}".replace("-", "−"), float(value), **more)


def means(shop: Workshop) -> list[Block]:
    """Means of the leading metrics from summary.csv, beside the paper's where it prints one."""
    table = shop.results.table("summary.csv", *statistics.SUMMARY)
    if table.empty:
        raise Missing("summary.csv holds no scores: no shape of the run has ground truth.")
    caption = MEANS
    if not paper.other_data(shop.results):
        caption += " The paper's mean AUC is that of its table of classes; it prints no mean of the other metrics."
    made: list[Block] = [means_table(shop, "means", caption, table[table["metric"].isin(shop.results.leading)])]
    if (table["model"] == "HS").any():
        made.append(Note(HUMAN))
    return made


MEANS = ("Means over the shapes that all models have a score for, with 95 % intervals of Student and of the bootstrap (BCa) over "
         "the units that n counts. Best of each data set and metric in bold, which does not say that it differs from the others.")
HUMAN = ("HS is one participant against all others, and no model. One person picks few points, so that most of such a map has "
         "the same value: a model, which values every point, may score above it without knowing more than people do together. "
         "The human curve shows what more participants reach.")


def means_table(shop: Workshop, identifier: str, caption: str, table: Frame) -> Table:
    compare = not paper.other_data(shop.results) and (table["metric"] == "auc").any()
    best = {key: shop.results.metric(key[1]).best(dict(zip(part["model"], part["mean"])))
            for key, part in table.groupby(["dataset", "metric"])}
    rows = []
    for row in table.to_dict("records"):
        dataset = row["dataset"]
        cells = [Cell(row["model"]), Cell(DATASETS.get(dataset, dataset)), Cell(shop.results.metric(row["metric"]).label),
                 count_cell(shop.results, dataset, row["n"], row["n_shapes"]),
                 cell(row["mean"], bold=row["model"] in best[dataset, row["metric"]], below=own_shapes(row)),
                 cell(row["ci95_low"]), cell(row["ci95_high"]), cell(row["sd"]), interval(row["bca95_low"], row["bca95_high"])]
        rows.append(cells + (paper_cells(row) if compare else []))
    heads = ["Model", "Data set", "Metric", units.HEAD, "Mean", "95 % low", "95 % high", "SD", "95 % by bootstrap"]
    heads += ["Paper", "Difference"] if compare else []
    return Table(identifier, caption, heads, rows, [False] * 3 + [True] * (len(heads) - 3), filters=[1, 2, 0], opens=first_of(rows, 1, 2))


def paper_cells(row: Row) -> list[Cell]:
    """The paper's mean, where it prints one, and the difference."""
    known = paper.mean_auc(row["model"]) if (row["dataset"], row["metric"]) == ("meshes", "auc") else None
    return [cell(known, 2), signed(row["mean"] - known) if known else cell(None)]


def own_shapes(row: Row) -> str:
    """The mean over all shapes that the model has a score for, where these are others than the compared ones."""
    if row["n_own_shapes"] == row["n_shapes"] or row["own_mean"] != row["own_mean"]:
        return ""
    kind = several(row["n_own_shapes"], KIND_NAMES.get(row["dataset"], "shape"))
    return f"{row['own_mean']:.3f} over all {kind} that it has a score for".replace("-", "−")


FEW = 5  # units of a class below which no model is set in bold: the mean of so few tells little of the class
CLASSES = ("{} per class on {}: mean, and half of its 95 % interval, or the ends where it was cut at the range of the metric; best in bold in "
           f"classes of at least {FEW} meshes{{}}.")


def per_class(shop: Workshop, dataset: str, metric: str) -> Table:
    """Classes by models, best in bold; below each of our means of AUC on meshes the paper's and the difference."""
    of = shop.results.metric(metric)
    table = statistics.per_class(shop.results, dataset, metric)
    models = [model for model in shop.models if (table["model"] == model).any()]
    by_cell = {(row["class"], row["model"]): row for _, row in table.iterrows()}
    average: dict[str, float] = {name: row["mean"] for (name, model), row in by_cell.items() if model == "Avg"}
    order = sorted(dict.fromkeys(table["class"]), key=lambda name: average.get(name, 0) * (1 if of.lower else -1))
    printed = (dataset, metric) == ("meshes", "auc") and not paper.other_data(shop.results)
    known = paper.per_class() if printed else {}
    best = best_per_class(of, by_cell)
    rows = []
    for name in order:
        numbers = [by_cell.get((name, model)) for model in models]
        cells = [Cell(name or "(no class)"), class_count(shop, dataset, numbers)]
        for row, model in zip([by_cell.get((name, "Avg")), *numbers], ["Avg", *models]):
            cells.append(class_cell(row, known.get((name, model)), model in best[name]))
        rows.append(cells)
    label = of.label
    identifier = f"classes-{dataset}-{shop.metric_files[metric]}"
    shop.write(f"data/{identifier}.tex", latex.per_class(order, models, by_cell, best, of, dataset, shop.results.simulated))
    files = [("LaTeX (booktabs)", f"data/{identifier}.tex")]
    remark = "; below: the paper's value and the difference" if known else ""
    return Table(identifier, CLASSES.format(label, spoken(dataset), remark), ["Class", units.HEAD, f"Avg-{label}", *models], rows,
                 [False] + [True] * (len(models) + 2), files=files)


def class_count(shop: Workshop, dataset: str, rows: Sequence[Row | None]) -> Cell:
    """The number of units and shapes of a class: of the model that has most."""
    known = [(row["n"], row["n_shapes"]) for row in rows if row is not None]
    return count_cell(shop.results, dataset, *max(known), within_class=True) if known else cell(None)


def best_per_class(metric: Metric, by_cell: Mapping[tuple[str, str], Row]) -> dict[str, set[str]]:
    """class -> its best models; none of a class of few. by_cell: (class, model or "Avg") -> a row with n and the mean."""
    means: dict[str, dict[str, float]] = {}
    for (name, model), row in by_cell.items():
        if model != "Avg" and row["n"] >= FEW:
            means.setdefault(name, {})[model] = row["mean"]
    return {name: metric.best(means.get(name, {})) for name, _ in by_cell}


def class_cell(row: Row | None, known: tuple[float, float] | None, bold: bool) -> Cell:
    if row is None or row["mean"] != row["mean"]:
        return cell(None)
    of_paper = f"paper {known[0]:.2f} ± {known[1]:.2f}, {row['mean'] - known[0]:+.2f}".replace("-", "−") if known else ""
    return cell(row["mean"], bold=bold, below=spread(row), further=of_paper)


def pairwise(shop: Workshop) -> Table:
    """The rows of significance.csv of the leading metrics."""
    table = significance(shop)
    return pairs_table(shop, "pairs", table[table["metric"].isin(shop.results.leading)])


def significance(shop: Workshop) -> Frame:
    columns = ["dataset", "metric", "model_a", "model_b", "n", "n_shapes", "mean_difference", "ci95_low", "ci95_high", "t_p", "t", "t_bound", "d_z",
               "rank_biserial", "superiority", "superiority_low", "superiority_high", "rank_sum_p", "signed_rank_p_holm", "n_tests"]
    table = shop.results.table("significance.csv", *columns)
    if table.empty:
        raise Missing("significance.csv holds no test: it takes two models and a shape with ground truth.")
    return table


PAIRS = ("Every pair of models, and whether the two differ when all models are compared at once, as in ranks, groups and sentences: they do "
         "where |t| is beyond its bound. The interval and p are those of the paired t-test over the units that n counts, for this pair alone. "
         "Signed-rank p: by Holm's correction over all pairs of one data set and metric, whose number stands below it; it is "
         "no test of means where differences are skewed. "
         "Effect: Cohen's d_z, below it the matched-pairs rank-biserial correlation. Higher: on how large a share of the units the "
         "first model has the higher score. Rank sum: the paper's test, which takes every shape for an independent one. "
         "Undecided: the test finds no difference, which does not say that there is none.")


def pairs_table(shop: Workshop, identifier: str, table: Frame) -> Table:
    rows = []
    for row in table.to_dict("records"):
        holm = p_value(row["signed_rank_p_holm"])
        holm.below = f"{int(row['n_tests'])} pairs" if row["n_tests"] == row["n_tests"] else ""
        rows.append([Cell(f"{row['model_a']} − {row['model_b']}", badge=jointly(row["t"], row["t_bound"])),
                     Cell(DATASETS.get(row["dataset"], row["dataset"])), Cell(shop.results.metric(row["metric"]).label),
                     count_cell(shop.results, row["dataset"], row["n"], row["n_shapes"]), signed(row["mean_difference"]),
                     interval(row["ci95_low"], row["ci95_high"]), p_value(row["t_p"]), decided(row["t_p"]),
                     nearness(row["t"], row["t_bound"]), holm,
                     signed(row["d_z"], 2, below=signed(row["rank_biserial"], 2).text),
                     cell(row["superiority"], 2, below=interval(row["superiority_low"], row["superiority_high"], 2).text),
                     p_value(row["rank_sum_p"])])
    return Table(identifier, PAIRS, ["Pair", "Data set", "Metric", units.HEAD, "Mean difference", "95 % interval", "p (t)", "This pair alone",
                                     "All pairs: |t|", "Signed-rank p (Holm)", "Effect", "Higher", "Rank sum p"],
                 rows, [False] * 3 + [True] * 4 + [False] + [True] * 5, filters=[1, 2, 0], opens=first_of(rows, 1, 2))


def decided(p: float) -> Cell:
    return cell(None) if p != p else Cell("differs", bold=True) if p < LEVEL else Cell("undecided")


def jointly(t: float, bound: float) -> tuple[str, str]:
    """The verdict on a pair when all are compared at once, as a badge; none on one with a reference."""
    return ("", "") if t != t or bound != bound else ("differ", "holds") if abs(t) > bound else ("undecided", "open")


def nearness(t: float, bound: float) -> Cell:
    """How near the verdict is: draws of another seed move the bound by some hundredths."""
    return cell(None) if t != t or bound != bound else cell(abs(t), below=f"bound {bound:.3f}")


def parameters(shop: Workshop) -> list[Block]:
    """Table 1: the paper's parameters and where each protocol puts them; then every option of the models."""
    ours = shop.results.option("protocol") or ""
    configuration = shop.results.record.get("configuration")
    flat = {name: model_options(values) for name, values in shop.protocols.items()}
    if configuration:
        own = model_options(configuration)
        if flat.get(ours) == own:
            del flat[ours]  # the run's own column says the same
        flat = {f"this run ({ours})" if ours else "this run": own} | flat
    rows = []
    for row in paper.read("parameters.csv").to_dict("records"):
        cells = [Cell(row["model"]), Cell(row["symbol"]), Cell(f"{row['value']} {row['unit']}".strip()), Cell(row["option"])]
        rows.append(cells + [parameter_cell(values, row) for values in flat.values()])
    return [Table("parameters", "Parameters of the models: the paper's, and the configuration's. R: radius of the bounding sphere.",
                  ["Model", "Symbol", "Paper", "Option", *flat], rows, [False] * (4 + len(flat))), all_options(flat)]


def parameter_cell(values: Mapping[str, str], row: Row) -> Cell:
    option, _, unless = row["unless"].partition("=")
    if option and values.get(option) == unless:
        return Cell("not used", below=f"{option}: {unless}")
    return Cell(f"{values[row['option']]} {row['unit']}".strip()) if row["option"] in values else Cell("–")


def all_options(flat: Mapping[str, Mapping[str, str]]) -> Fold:
    paths = dict.fromkeys(path for values in flat.values() for path in values)
    rows = []
    for path in paths:
        values = [options.get(path, "–") for options in flat.values()]
        differ = len(set(values)) > 1
        rows.append([Cell(path)] + [Cell(value, bold=differ) for value in values])
    return Fold("Every option", [Table("options", "Every option of models, descriptors and normals; bold where the columns differ.",
                                       ["Option", *flat], rows, [False] * (1 + len(flat)))])


def model_options(configuration: Mapping[str, Any]) -> dict[str, str]:
    """The options that saliency maps depend on, by path."""
    sections = ("models.", "fpfh.", "scan_fpfh.", "normals.", "scan_normals.", "surface.")
    return {path: value for path, value in flatten(configuration).items() if path.startswith(sections)}
