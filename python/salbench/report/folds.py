# SPDX-License-Identifier: GPL-3.0-or-later
"""Folds of a cross-validation: the shapes that each was scored and trained on, scores by fold, and training
time beside the time per map."""

from salbench.conclusions.units import REFERENCES
from salbench.pages.blocks import Block, Missing, Table, cell
from salbench.pages.columns import Column, counted, number, sheet, text
from salbench.report import statistics
from salbench.report.results import Row, Shown
from salbench.report.report import Report
from salbench.report.units import DATA_SET, OF_A_METRIC, metric_of

NAMED = 6  # shapes listed per fold


def listing(report: Report) -> Table:
    table = report.results.table("folds")
    classes = statistics.classes(report.results)
    rows = []
    for fold, of in table.groupby("fold"):
        scored = list(of.loc[of["role"] == "scored", "item"])
        groups = list(dict.fromkeys(filter(None, (classes.get(item) for item in scored))))
        rows.append(
            {
                "fold": fold,
                "scored": len(scored),
                "trained": int((of["role"] == "trained on").sum()),
                "classes": ", ".join(groups),
                "names": ", ".join(scored[:NAMED])
                + f" and {len(scored) - NAMED} more" * (len(scored) > NAMED),
            }
        )
    how = "; ".join(dict.fromkeys(report.results.trained.values()))
    columns = [
        counted("Fold", "fold"),
        counted("Scored", "scored"),
        counted("Trained on", "trained"),
        text("Classes scored", "classes"),
        text("Shapes scored", "names"),
    ]
    return sheet(
        "folds",
        (
            f"Folds, numbered as in folds.csv, which names all shapes{': ' * bool(how)}{how}. No map is made"
            " by a model that was trained on its shape."
        ),
        columns,
        rows,
    )


def scores(report: Report) -> Table:
    """Means of the trained models, by fold, over the shapes that all competitors are scored on."""
    results = report.results
    rows = [
        row
        for dataset in statistics.shown(results)
        for metric in results.leading
        for row in _by_fold(results, dataset, metric)
    ]
    if not rows:
        raise Missing("No model that was trained has scores.")
    folds = sorted(set(results.table("folds")["fold"].astype(int)))
    columns = [
        text("Model", "model"),
        DATA_SET,
        metric_of(results),
        number("Mean", "mean"),
        *map(_of_fold, folds),
    ]
    return sheet(
        "fold-means",
        (
            f"Mean score over all folds, and per fold, on the shapes that every model{results.of_these} has a"
            " score for. Folds hold different shapes, so they differ for every model: compare models within"
            " one."
        ),
        columns,
        rows,
        OF_A_METRIC,
        2,
    )


def _of_fold(fold: int) -> Column:
    return Column(f"Fold {fold}", lambda row: cell(row["folds"].get(fold)))


def _by_fold(results: Shown, dataset: str, metric: str) -> list[Row]:
    try:
        table = statistics.scores(results, dataset, metric)
    except Missing:
        return []
    scored = [model for model in table if table[model].notna().any()]
    table = table.dropna(subset=[model for model in scored if model not in REFERENCES])
    folds = results.table("folds")
    fold_of = dict(folds.loc[folds["role"] == "scored", ["item", "fold"]].itertuples(index=False))
    numbers = [fold_of.get(f"{item}_{view}", fold_of.get(item)) for item, view in table.index]
    means = table.groupby(numbers).mean()
    return [
        {
            "dataset": dataset,
            "metric": metric,
            "model": model,
            "mean": table[model].mean(),
            "folds": means[model].to_dict(),
        }
        for model in scored
        if model in results.trained
    ]


def costs(report: Report) -> list[Block]:
    results = report.results
    trained = results.table("training")
    per_map = results.table("costs").groupby("model")["seconds"].median() if results.has("costs") else {}
    rows = [
        {
            "model": model,
            "folds": len(of),
            "known": int(of["seconds"].count()),
            "shapes": of["shapes"].mean(),
            "sum": of["seconds"].sum(min_count=1),
            "median": of["seconds"].dropna().median(),  # of none: NaN without a warning
            "map": per_map.get(model, float("nan")),
        }
        for model, of in trained[trained["model"].isin(results.trained)].groupby("model", sort=False)
    ]
    if not rows:
        raise Missing("No model was trained that has maps.")
    columns = [
        text("Model", "model"),
        counted("Folds", "folds"),
        counted("Timed", "known"),
        number("Shapes trained on", "shapes", 1),
        number("Seconds of training, all folds", "sum", 2),
        number("Median s per fold", "median", 3),
        number("Median s per map", "map", 4),
    ]
    return [
        sheet(
            "training",
            (
                "Seconds that training took, on whatever machine that was, beside the seconds per map, which"
                " have neither training nor loading in them. Timed: folds whose training was timed by a run"
                " into this folder, or is noted in the file that keep= wrote."
            ),
            columns,
            rows,
        )
    ]
