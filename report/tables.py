# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's tables of scores: means, classes, pairwise tests, parameters."""

from report import paper, statistics
from report.blocks import Cell, Note, Table, cell, count, p_value
from report.latex import write_per_class
from report.names import DATASETS, spoken
from report.results import Missing

LEVEL = 0.05  # of the paper's tests


def signed(value, digits=3):
    return cell(value, digits) if value != value else Cell(f"{value:+.{digits}f}".replace("-", "−"), float(value))


def means(shop):
    """Means of the leading metrics from summary.csv, beside the paper's where it prints one."""
    table = shop.results.table("summary.csv", "dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high")
    if table.empty:
        raise Missing("summary.csv holds no scores: no shape of the run has ground truth.")
    caption = ("Means over the shapes. Best of each data set and metric in bold. The paper's mean AUC is that of its table of "
               "classes; it prints no mean of the other metrics.")
    return means_table(shop, "means", caption, table[table["metric"].isin(shop.results.leading)])


def means_table(shop, identifier, caption, table):
    compare = not shop.results.simulated  # the paper's scores are of people
    best = {key: shop.results.metric(key[1]).best(dict(zip(part["model"], part["mean"])))
            for key, part in table.groupby(["dataset", "metric"])}
    rows = []
    for row in table.to_dict("records"):
        printed = compare and (row["dataset"], row["metric"]) == ("meshes", "auc")
        known = paper.mean_auc(row["model"]) if printed else None
        rows.append([Cell(DATASETS.get(row["dataset"], row["dataset"])), Cell(row["model"]),
                     Cell(shop.results.metric(row["metric"]).label), count(row["n"]),
                     cell(row["mean"], bold=row["model"] in best[row["dataset"], row["metric"]]),
                     cell(row["ci95_low"]), cell(row["ci95_high"]), cell(row["sd"]), cell(known, 2), signed(row["mean"] - known) if known else cell(None)])
    return Table(identifier, caption,
                 ["Data set", "Model", "Metric", "Shapes", "Mean", "95 % low", "95 % high", "SD", "Paper", "Difference"],
                 rows, [False] * 3 + [True] * 7, filters=[0, 1, 2])


def per_class(shop, dataset, metric):
    """Classes by models, best in bold; below each of our means of AUC on meshes the paper's and the difference."""
    of = shop.results.metric(metric)
    table = statistics.per_class(shop.results, dataset, metric)
    models = [model for model in shop.models if (table["model"] == model).any()]
    by_cell = {(row["class"], row["model"]): row for _, row in table.iterrows()}
    average = {name: row["mean"] for (name, model), row in by_cell.items() if model == "Avg"}
    order = sorted(dict.fromkeys(table["class"]), key=lambda name: average.get(name, 0) * (1 if of.lower else -1))
    printed = (dataset, metric) == ("meshes", "auc") and not shop.results.simulated
    known = paper.per_class() if printed else {}
    best = best_per_class(of, by_cell)
    rows = []
    for name in order:
        numbers = [by_cell.get((name, model)) for model in models]
        shapes = max((row["n"] for row in numbers if row is not None), default=0)
        cells = [Cell(name or "(no class)"), count(shapes)]
        for row, model in zip(numbers + [by_cell.get((name, "Avg"))], models + ["Avg"]):
            cells.append(class_cell(row, known.get((name, model)), model in best[name]))
        rows.append(cells)
    label = of.label
    identifier = f"classes-{dataset}-{shop.metric_files[metric]}"
    write_per_class(shop.file(f"data/{identifier}.tex"), order, models, by_cell, best, of, dataset, shop.results.simulated)
    files = [("LaTeX (booktabs)", f"data/{identifier}.tex")]
    remark = "; below: the paper's value and the difference" if known else ""
    return Table(identifier, f"{label} per class on {spoken(dataset)}: mean and half of the 95 % interval, best in bold{remark}.",
                 ["Class", "Shapes"] + models + [f"Avg-{label}"], rows, [False] + [True] * (len(models) + 2), files=files)


def best_per_class(metric, by_cell):
    """class -> its best models. by_cell: (class, model or "Avg") -> a row with the mean."""
    means = {}
    for (name, model), row in by_cell.items():
        if model != "Avg":
            means.setdefault(name, {})[model] = row["mean"]
    return {name: metric.best(means.get(name, {})) for name, _ in by_cell}


def class_cell(row, known, bold):
    if row is None or row["mean"] != row["mean"]:
        return cell(None)
    spread = f" ± {row['ci95']:.3f}" if row["ci95"] == row["ci95"] else ""
    below = ""
    if known:
        below = f"paper {known[0]:.2f} ± {known[1]:.2f}, {row['mean'] - known[0]:+.2f}".replace("-", "−")
    return Cell(f"{row['mean']:.3f}{spread}".replace("-", "−"), float(row["mean"]), bold=bold, below=below)


def pairwise(shop):
    """The rows of significance.csv of the leading metrics; both tests at 0.05."""
    table = significance(shop)
    return pairs_table(shop, "pairs", table[table["metric"].isin(shop.results.leading)])


def significance(shop):
    columns = ["dataset", "metric", "model_a", "model_b", "n", "mean_difference", "rank_sum_p", "signed_rank_p_holm"]
    table = shop.results.table("significance.csv", *columns)
    if table.empty:
        raise Missing("significance.csv holds no test: it takes two models and a shape with ground truth.")
    return table


def pairs_table(shop, identifier, table):
    rows = []
    for row in table.to_dict("records"):
        rows.append([Cell(DATASETS.get(row["dataset"], row["dataset"])),
                     Cell(shop.results.metric(row["metric"]).label), Cell(f"{row['model_a']} − {row['model_b']}"),
                     count(row["n"]), signed(row["mean_difference"]), p_value(row["rank_sum_p"]), decided(row["rank_sum_p"]),
                     p_value(row["signed_rank_p_holm"]), decided(row["signed_rank_p_holm"])])
    return Table(identifier, f"Every pair of models at level {LEVEL}: the paper's rank-sum test, and the paired signed-rank test "
                 "with Holm's correction over the pairs.",
                 ["Data set", "Metric", "Pair", "Shapes", "Mean difference", "Rank sum p", "Differs", "Signed rank p (Holm)",
                  "Differs (Holm)"], rows, [False] * 3 + [True, True, True, False, True, False], filters=[0, 1, 2])


def decided(p):
    return cell(None) if p != p else Cell("yes", bold=True) if p < LEVEL else Cell("no")


def participants_worth(shop):
    """For each model and leading metric the smallest n whose human curve reaches the model's mean."""
    curve = shop.results.table("human_curve.csv", "n", "metric", "mean").dropna(subset=["n", "mean"])
    rows = []
    for model in shop.models:
        if model == "HS":
            continue
        cells = [Cell(model)]
        for metric, of in shop.results.leading.items():
            summary = statistics.summary(shop.results, "meshes", metric)
            mean = summary.loc[summary["model"] == model, "mean"]
            part = curve[curve["metric"] == metric].sort_values("n")
            sign = -1 if of.lower else 1
            reached = part[sign * part["mean"] >= sign * mean.iloc[0]] if len(mean) else part.iloc[:0]
            if not len(mean) or part.empty or mean.iloc[0] != mean.iloc[0]:
                cells.append(cell(None))
            elif reached.empty:
                cells.append(Cell(f"more than {int(part['n'].max())}", float(part["n"].max()) + 1))
            else:
                first = int(reached["n"].iloc[0])
                cells.append(Cell("1 or fewer" if first == 1 else f"{first - 1} to {first}", first))
        rows.append(cells)
    if not rows:
        raise Missing("The run has no model to compare with the participants.")
    return Table("worth", "How many participants a model is worth: where the human curve reaches the model's mean.",
                 ["Model"] + [of.label for of in shop.results.leading.values()], rows,
                 [False] + [True] * len(shop.results.leading))


def parameters(shop):
    """Table 1: the paper's parameters and where each protocol puts them; then every option of the models."""
    ours = shop.results.option("protocol")
    configuration = shop.results.record.get("configuration")
    flat = {name: model_options(values) for name, values in shop.protocols.items()}
    if isinstance(configuration, dict):
        own = model_options(configuration)
        if flat.get(ours) == own:
            del flat[ours]  # the run's own column says the same
        flat = {f"this run ({ours})" if ours else "this run": own} | flat
    if not flat:
        raise Missing("run.yaml holds no configuration.")
    blocks = []
    for protocol in ("published", "text"):
        if protocol not in shop.protocols and ours != protocol:
            blocks.append(Note(f"The column of protocol {protocol} is missing: scripts/report asks the built program for it, "
                               "and found none.", missing=True))
    rows = []
    for row in paper.read("parameters.csv").to_dict("records"):
        cells = [Cell(row["model"]), Cell(row["symbol"]), Cell(f"{row['value']} {row['unit']}".strip()), Cell(row["option"])]
        rows.append(cells + [parameter_cell(values, row) for values in flat.values()])
    blocks.append(Table("parameters", "Parameters of the models: the paper's, and the configuration's. R: radius of the "
                        "bounding sphere.", ["Model", "Symbol", "Paper", "Option", *flat], rows, [False] * (4 + len(flat))))
    return blocks + [all_options(flat)]


def parameter_cell(values, row):
    option, _, unless = row["unless"].partition("=")
    if option and values.get(option) == unless:
        return Cell("not used", below=f"{option}: {unless}")
    return Cell(f"{values[row['option']]} {row['unit']}".strip()) if row["option"] in values else Cell("–")


def all_options(flat):
    paths = dict.fromkeys(path for values in flat.values() for path in values)
    rows = []
    for path in paths:
        values = [options.get(path, "–") for options in flat.values()]
        differ = len(set(values)) > 1
        rows.append([Cell(path)] + [Cell(value, bold=differ) for value in values])
    return Table("options", "Every option of models, descriptors and normals; bold where the columns differ.",
                 ["Option", *flat], rows, [False] * (1 + len(flat)), folded="Every option")


def model_options(configuration):
    """The options that saliency maps depend on, by path."""
    sections = ("models.", "fpfh.", "scan_fpfh.", "normals.", "scan_normals.", "surface.")
    return {path: value for path, value in flatten(configuration).items() if path.startswith(sections)}


def flatten(values, prefix=""):
    """{"fpfh": {"radius": "0.01"}} -> {"fpfh.radius": "0.01"}"""
    flat = {}
    for key, value in values.items():
        if isinstance(value, dict):
            flat |= flatten(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)
    return flat
