# SPDX-License-Identifier: GPL-3.0-or-later
"""Two runs side by side: what they were, how their configurations differ, their means, and the differences per shape."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import pandas

from salbench.conclusions.samples import summarise
from salbench.pages.blocks import Block, Cell, Fold, Missing, Note, attempt, signed
from salbench.pages.columns import Column, between, number, sheet, text
from salbench.pages.names import DATASETS
from salbench.report import score_pages, statistics
from salbench.report.pages import Page, Pages
from salbench.report.results import Frame, Results, Row, flatten
from salbench.report.units import DATA_SET, MODEL, OF_A_METRIC, metric_of, n_of
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


def write_page(pages: Pages, page: Page) -> None:
    shop, other = pages.shop, pages.shop.other
    assert other is not None
    first, second = names(shop.results, other)
    score_pages.write(pages, page, partial(differences, shop, other), blocks(shop, other), title="Comparison", heading="Two runs side by side",
                      shapes={}, caption=f"Score in {first} less score in {second}. A dash: undefined or missing in one of them.")


def blocks(shop: Workshop, other: Results) -> list[tuple[str, list[Block]]]:
    """(title, blocks) of each section."""
    return [("Means", attempt(means, shop, other)),
            ("What was run", attempt(facts, shop.results, other)),
            ("Configuration", attempt(configuration, shop.results, other)),
            ("Versions", attempt(versions, shop.results, other))]


def names(results: Results, other: Results) -> tuple[str, str]:
    """Heads of the two columns; the folders' names where they tell the runs apart."""
    first, second = results.folder.resolve().name, other.folder.resolve().name
    return (first, second) if first != second else (str(results.folder), str(other.folder))


def facts(results: Results, other: Results) -> Block | list[Block]:
    rows = [(label, [read(run) or ABSENT for run in (results, other)]) for label, read in FACTS.items()]

    def value(row: tuple[str, list[str]], at: int) -> Cell:
        return Cell(row[1][at], bold=row[1][0] != row[1][1])
    columns = [text("What", lambda row: row[0])]
    columns += [Column(name, partial(value, at=at), numeric=False) for at, name in enumerate(names(results, other))]
    table = sheet("compared-facts", "The two runs; bold where they differ.", columns, rows)
    if digest(results) != digest(other):
        return [Note("The runs were over different data: means of one are of other shapes than those of the other. Differences "
                     "below are over the shapes that both have."), table]
    return table


def entry(of: Mapping[str, str], key: str) -> str:
    return of.get(key, ABSENT)


def differing(first: Mapping[str, str], second: Mapping[str, str], caption: str, identifier: str, heads: Sequence[str], what: str) -> Block:
    keys = [key for key in dict.fromkeys([*first, *second]) if first.get(key) != second.get(key)]
    if not keys:
        return Note(f"{what} are the same in both runs.")
    columns = [text(head, partial(entry, of)) for head, of in zip(heads, (first, second))]
    return sheet(identifier, caption, [text("What", str), *columns], keys)


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
    rows: list[Row] = []
    for dataset, metric, first, second in pairs_of_scores(shop.results, other):
        for model in first:
            both = pandas.DataFrame({"first": first[model], "second": second[model]}).dropna()
            if both.empty:
                continue
            units = statistics.by_unit(shop.results, both)
            _, mean, _, low, high = summarise((units["first"] - units["second"]).to_numpy()[:, None])
            rows.append({"model": model, "dataset": dataset, "metric": metric, "n": len(units), "n_shapes": len(both), "first": units["first"].mean(),
                         "second": units["second"].mean(), "difference": mean[0], "low": low[0], "high": high[0]})
    if not rows:
        raise Missing("The two runs have no model with scores of the same shape.")
    missing = sorted(set(shop.models) ^ set(statistics.models(other)))
    notes: list[Block] = [Note(f"Models that only one run has are left out: {', '.join(missing)}.")] if missing else []
    first_name, second_name = names(shop.results, other)
    columns = [MODEL, DATA_SET, metric_of(shop.results), n_of(shop.results), number(first_name, "first"), number(second_name, "second"),
               Column("Difference", lambda row: signed(row["difference"])), between("95 % interval", "low", "high")]
    own, further = (sheet(name, "Means over the shapes that both runs scored, and the mean difference with its paired 95 % interval over the units "
                          "that n counts.", columns, [row for row in rows if (row["metric"] in shop.results.leading) == is_leading],
                          (*OF_A_METRIC, "Model"), 2) for name, is_leading in (("compared-means", True), ("compared-means-others", False)))
    return [*notes, *([own] if own.rows else []), *([Fold("Other metrics", [further])] if further.rows else [])]


def differences(shop: Workshop, other: Results) -> dict[str, Any]:
    """What comparison.html's script reads: as score_pages.data, with differences in place of scores."""
    return score_pages.page_data(shop, {(dataset, metric): first - second
                            for dataset, metric, first, second in pairs_of_scores(shop.results, other)})
