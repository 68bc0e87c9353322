# SPDX-License-Identifier: GPL-3.0-or-later
"""Two runs side by side: what they were, how their configurations differ, their means, and the differences per shape."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import pandas

from salbench.conclusions.samples import summarise
from salbench.pages.blocks import Block, Cell, Fold, Missing, Note, Table, attempt, cell, first_of, interval
from salbench.pages.names import DATASETS
from salbench.report import statistics
from salbench.report.results import Frame, Results, flatten
from salbench.report.score_pages import page_data
from salbench.report.tables import signed
from salbench.report.units import HEAD, count_cell
from salbench.report.workshop import Workshop

ABSENT = "–"


def digest(results: Results) -> str:
    return str(results.record.get("data_set", {}).get("digest", ""))


FACTS: dict[str, Callable[[Results], str | None]] = {
    "Program": lambda run: run.record.get("program"),
    "Results": lambda run: run.state,
    "Protocol": lambda run: run.option("protocol"),
    "Seed": lambda run: run.option("seed"),
    "Data, digest": digest,
    "Reference": lambda run: run.record.get("reference"),
    "Models of one's own": lambda run: ", ".join(run.evaluated),
    "Participants": lambda run: "simulated" if run.simulated else "measured",
}


def blocks(shop: Workshop, other: Results) -> list[tuple[str, list[Block]]]:
    """(title, blocks) of each section."""
    return [("What was run", attempt(facts, shop.results, other)),
            ("Configuration", attempt(configuration, shop.results, other)),
            ("Versions", attempt(versions, shop.results, other)),
            ("Means", attempt(means, shop, other))]


def names(results: Results, other: Results) -> tuple[str, str]:
    """Heads of the two columns; the folders' names where they tell the runs apart."""
    first, second = results.folder.resolve().name, other.folder.resolve().name
    return (first, second) if first != second else (str(results.folder), str(other.folder))


def facts(results: Results, other: Results) -> Block | list[Block]:
    rows = []
    for label, read in FACTS.items():
        values = [read(run) or ABSENT for run in (results, other)]
        rows.append([Cell(label)] + [Cell(value, bold=values[0] != values[1]) for value in values])
    heads = ["What", *names(results, other)]
    table = Table("compared-facts", "The two runs; bold where they differ.", heads, rows, [False] * 3)
    if digest(results) != digest(other):
        return [Note("The runs were over different data: means of one are of other shapes than those of the other. Differences "
                     "below are over the shapes that both have."), table]
    return table


def differing(first: Mapping[str, str], second: Mapping[str, str], caption: str, identifier: str, heads: Sequence[str], what: str) -> Block:
    rows = [[Cell(key), Cell(first.get(key, ABSENT)), Cell(second.get(key, ABSENT))]
            for key in dict.fromkeys([*first, *second]) if first.get(key) != second.get(key)]
    if not rows:
        return Note(f"{what} are the same in both runs.")
    return Table(identifier, caption, ["What", *heads], rows, [False] * 3)


def configuration(results: Results, other: Results) -> Block:
    first, second = (run.record.get("configuration") for run in (results, other))
    if not first or not second:
        raise Missing("One of the two run.yaml holds no configuration.")
    return differing(flatten(first), flatten(second), "Options that differ.", "compared-options", names(results, other),
                     "All options")


def versions(results: Results, other: Results) -> Block:
    found = []
    for run in (results, other):
        stages = run.record.get("stages")
        if not stages:
            raise Missing("One of the two run.yaml does not name the versions of its stages.")
        found.append({stage: entry.get("version", "") for stage, entry in stages.items()})
    return differing(found[0], found[1], "Stages whose version differs, or that only one run has.", "compared-versions",
                     names(results, other), "The versions of all stages")


def pairs_of_scores(results: Results, other: Results) -> Iterator[tuple[str, str, Frame, Frame]]:
    """(data set, metric, scores of one run, scores of the other) over the shapes and models that both have."""
    for dataset in DATASETS:
        for metric in results.metrics:
            try:
                first, second = (statistics.scores(run, dataset, metric) for run in (results, other))
            except Missing:
                continue
            shapes = first.index.intersection(second.index, sort=False)
            models = [model for model in first if model in second]
            if len(shapes) and models:
                yield dataset, metric, first.loc[shapes, models], second.loc[shapes, models]


def means(shop: Workshop, other: Results) -> list[Block]:
    rows: list[list[Cell]] = []
    others: list[list[Cell]] = []
    for dataset, metric, first, second in pairs_of_scores(shop.results, other):
        for model in first:
            both = pandas.DataFrame({"first": first[model], "second": second[model]}).dropna()
            if both.empty:
                continue
            units = statistics.by_unit(shop.results, both)
            _, mean, _, low, high = summarise((units["first"] - units["second"]).to_numpy()[:, None])
            row = [Cell(model), Cell(DATASETS[dataset]), Cell(shop.results.metric(metric).label),
                   count_cell(shop.results, dataset, len(units), len(both)), cell(units["first"].mean()),
                   cell(units["second"].mean()), signed(mean[0]), interval(low[0], high[0])]
            (rows if metric in shop.results.leading else others).append(row)
    if not rows + others:
        raise Missing("The two runs have no model with scores of the same shape.")
    missing = sorted(set(shop.models) ^ set(statistics.models(other)))
    notes: list[Block] = [Note(f"Models that only one run has are left out: {', '.join(missing)}.")] if missing else []
    caption = ("Means over the shapes that both runs scored, and the mean difference with its paired 95 % interval over the units "
               "that n counts.")
    heads = ["Model", "Data set", "Metric", HEAD, *names(shop.results, other), "Difference", "95 % interval"]
    own, further = (Table(name, caption, heads, part, [False] * 3 + [True] * 5, filters=[1, 2, 0], opens=first_of(part, 1, 2))
                    for name, part in (("compared-means", rows), ("compared-means-others", others)))
    return [*notes, *([own] if rows else []), *([Fold("Other metrics", [further])] if others else [])]


def differences(shop: Workshop, other: Results) -> dict[str, Any]:
    """What comparison.html's script reads: as score_pages.data, with differences in place of scores."""
    return page_data(shop, {(dataset, metric): first - second
                            for dataset, metric, first, second in pairs_of_scores(shop.results, other)})
