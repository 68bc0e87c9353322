# SPDX-License-Identifier: GPL-3.0-or-later
"""The first screen: who leads and with what certainty, how far the others are behind, the meaning of the
letters, three shapes, and facts on the data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import pandas

from salbench._core import models_about
from salbench.conclusions import glossary, words
from salbench.conclusions.units import datasets_in_views
from salbench.pages import dots
from salbench.pages.blocks import Missing
from salbench.pages.dots import number
from salbench.pages.names import DATASETS, KIND_NAMES, several
from salbench.pages.reported import WORDS
from salbench.report import gallery, mine, reported, statistics
from salbench.report.names import short
from salbench.report.report import Page, Report
from salbench.report.results import Shown
from salbench.runs import failed

# layouts of the paper's data: SHREC'07 with the ground truth of the Schelling study
LAYOUTS = ("schelling", "princeton", "gs")
PANELS = 2  # data sets with panels; the page of the ranking has all
MODELS = 6  # rows of a panel; the page of the ranking has all
MOST_NAME = 8  # em for names on one line


@dataclass
class Panel:
    """The best models of a data set by one metric, with the distance of each from the best mean."""

    title: str
    better: str  # "higher" or "lower"
    rows: "list[Row]"
    axis: dots.Axis
    more: int = 0  # models that are left out


@dataclass
class Row:
    model: str
    name: str  # names are kept while there is room
    mean: str
    group: str
    dot: dots.Dot | None


def write_page(report: Report, page: Page) -> None:
    """Writes index.html, with a note for each missing part."""
    missing: dict[str, None] = {}

    def found(build: Callable[[Report], Any], otherwise: Any) -> Any:
        try:
            return build(report)
        except Missing as reason:
            missing[str(reason)] = None
            return otherwise

    values = {
        "sentences": found(sentences, []),
        "letters": found(letters, ([], [])),
        "panels": found(panels, []),
        "shapes": found(shapes, ([], "")),
        "facts": found(facts, []),
    }
    rows = [row for _, of in values["panels"] for panel in of for row in panel.rows]
    # in em of bold letters
    width, group_width = (
        max(least, round(0.68 * max((len(getattr(row, name)) for row in rows), default=0) + more, 1))
        for name, least, more in (("name", 3.4, 0), ("group", 1.8, 0.6))
    )
    report.write_page(
        page.path,
        "index.html",
        title=page.label,
        missing=missing,
        name_width=width,
        group_width=group_width,
        is_wide=width > MOST_NAME,
        these=report.results.of_these,
        doors=report.pages[1:],
        **values,
    )


def sentences(report: Report) -> list[tuple[str, str]]:
    """Pairs (data set, sentence on who leads), preceded by one on missing models."""
    said = (
        [("Missing", missing)]
        if (missing := failed.sentence(report.results.folder, report.results.record))
        else []
    )
    for dataset in statistics.shown(report.results):
        found = [brief(report.results, dataset, metric) for metric in report.results.leading]
        known = [of for of in found if of]
        if known:
            said.append((heading(report.results, dataset), words.brief(known)))
        if report.results.mine:
            try:
                text = mine.sentence(report.results, dataset)
            except Missing as reason:
                text = str(reason)
            if text and (report.results.mine, text) not in said:
                said.append((report.results.mine, text))
    return said


def heading(results: Shown, dataset: str) -> str:
    """Heading of a data set: "Meshes", "Meshes of split test", "Meshes of all splits"."""
    return f"{DATASETS[dataset]}{words.of_split(results.split_of(dataset), results.in_splits)}"


def brief(results: Shown, dataset: str, metric: str) -> words.Brief | None:
    """Brief of leaders.csv for a metric, over all splits together."""
    rows = results.rows("leaders", dataset, metric)
    if rows.empty:
        return None
    return words.brief_of(
        rows.iloc[0],
        results.metric(metric).label,
        list(results.rows("ranking", dataset, metric)["model"]),
        not results.wanted_models,
    )


def letters(report: Report) -> tuple[list[tuple[str, str, str, str]], list[tuple[str, str]]]:
    """Letters and meanings of models and leading metrics. For your own models, the description in run.yaml;
    those with the same one are grouped. Models also have a source and its address."""
    program = {
        name: models_about[name]
        for name in report.models
        if name in models_about and name not in report.results.evaluated
    }
    known = {name: (about.name, about.source, about.link) for name, about in program.items()}
    known |= {name: (report.results.told_of(name), "", "") for name in report.models if name not in program}
    alike: dict[tuple[str, str, str], list[str]] = {}
    for name, told in known.items():
        alike.setdefault(told, []).append(name)
    return (
        [(", ".join(names), *told) for told, names in alike.items() if told[0]],
        [
            (of.label, f"{glossary.compares(name)}; {glossary.range_of(name)}, {glossary.better(name)}")
            for name, of in report.results.leading.items()
            if glossary.compares(name)
        ],
    )


def panels(report: Report) -> list[tuple[str, list[Panel]]]:
    """Panels of each data set."""
    found = []
    for dataset in statistics.shown(report.results):
        of_metrics = []
        for metric in report.results.leading:
            try:
                of_metrics.append(panel(report, dataset, metric, MODELS))
            except Missing:
                continue
        if of_metrics:
            found.append((DATASETS[dataset], of_metrics))
    if not found:
        report.results.table("compact")
        raise Missing("No shape has scores: there is nothing to compare.")
    return found[:PANELS]


def panel(report: Report, dataset: str, metric: str, most: int) -> Panel:
    results = report.results
    of = results.metric(metric)
    ranked = results.rows("ranking", dataset, metric)
    models = behind(results, dataset, metric)
    references = [one for one in models if one.model in dots.LINES]
    models = models[: len(models) - len(references)]
    shown = models[:most]
    shown[most - 1 :] = [one for one in models[most - 1 :] if one.model == results.mine] or shown[most - 1 :]
    drawn = dots.drawn(
        [*shown, *references], first_of(results, dataset, metric), report.looks, results.of_these
    )
    groups, names = dict(zip(ranked["model"], ranked["group"])), short(report.models)
    rows = [
        Row(one.model, names[one.model], number(one.mean), groups[one.model], drawn[one.model].dot)
        for one in shown
    ]
    return Panel(
        of.label, "lower" if of.lower else "higher", rows, drawn[dots.AXIS].axis, len(models) - len(shown)
    )


def behind(results: Shown, dataset: str, metric: str) -> list[dots.Behind]:
    """Distances of the shown models from the best."""
    ranking = results.rows("ranking", dataset, metric).to_dict("records")
    compact = statistics.compact(results, dataset, metric).to_dict("records")
    pairs = (
        results.rows("significance", dataset, metric).to_dict("records")
        if results.has("significance")
        else []
    )
    found = dots.behind(ranking, pairs, compact, results.metric(metric).lower)
    if not found:
        raise Missing(f"ranking.csv ranks no model by {results.metric(metric).label}.")
    return found


def first_of(results: Shown, dataset: str, metric: str) -> list[str]:
    """Models on the pages that may be the best by a metric."""
    try:
        rows = results.rows("leaders", dataset, metric)
    except Missing:
        return []
    found = words.names_in(rows["leaders"].iloc[0]) if len(rows) else []
    return [name for name in found if name in (results.wanted_models or found)]


def shapes(report: Report) -> tuple[list[tuple[Any, ...]], str]:
    """Tuples (label, shape, page, score, [(picture, alt)]) for the best, the median and the worst shape with
    pictures, by the score of the first leader shown, or of the best mean if there is none; and a caption. A
    single shape has no label."""
    metric, of = next(iter(report.results.leading.items()))
    for dataset in statistics.shown(report.results):
        leaders = (
            [report.results.mine]
            if report.results.mine
            else first_of(report.results, dataset, metric)
            or list(report.results.rows("ranking", dataset, metric)["model"])
        )
        if not leaders:
            continue
        scores = (
            statistics.scores(report.results, dataset, metric)
            .get(leaders[0], pandas.Series(dtype=float))
            .dropna()
        )
        pictured = [
            shape
            for shape in gallery.scored_pictures(report, dataset)
            if (shape.item, shape.view) in scores.index and shape.has(leaders[0])
        ]
        if pictured:
            break
    else:
        return [], ""
    pictured.sort(key=lambda shape: float(scores[shape.item, shape.view]), reverse=not of.lower)
    last = len(pictured) - 1
    chosen = {last // 2: "Typical", last: "Worst", 0: "Best" if last else ""}
    found: list[tuple[Any, ...]] = []
    for shape, label in ((pictured[at], label) for at, label in sorted(chosen.items())):
        pictures = [
            (shape.painted["ground truth", "before"], f"What people marked on {shape.name}"),
            (shape.painted[leaders[0], "before"], f"Map of {leaders[0]} on {shape.name}"),
        ]
        found.append(
            (
                label,
                str(shape),
                report.page_of(shape.item),
                f"{of.label} {number(scores[shape.item, shape.view])}",
                pictures,
            )
        )
    which = ("best and worst", "best, median and worst")[last > 1]
    of_what = f"its {which} {KIND_NAMES[dataset]} by {of.label}, of {last + 1}" if last else "the one shape"
    marked = "the simulated ground truth" if report.results.simulated else "what people marked"
    return found, f"{leaders[0]} on {of_what} with pictures: {marked}, and its map."


def facts(report: Report) -> list[tuple[str, str]]:
    """Pairs (term, text) on the data and its limits."""
    results = report.results
    shapes = results.table("results").drop_duplicates(["dataset", "item", "view"])
    counts, in_views = shapes["dataset"].value_counts(), datasets_in_views(shapes)
    items = shapes.drop_duplicates(["dataset", "item"])["dataset"].value_counts()
    counted = ", ".join(
        (
            f"{several(counts[name], 'view')} of {several(items[name], KIND_NAMES[name])}"
            if name in in_views and name != "scans"
            else several(counts[name], KIND_NAMES[name])
        )
        for name in DATASETS
        if name in counts
    )
    protocol = results.option("protocol")
    unit = words.observation(results.unit, [name for name in DATASETS if name in counts], in_views)
    method = [
        f"protocol {protocol}" if protocol else "",
        f"one observation is a {unit}" if unit and results.unit else "",
        "intervals are 95 %",
    ]
    said_by_papers, reason = reported.said(results), other_data(results)
    copies = results.record.get("copies", [])
    found = [
        ("Shapes", f"{counted or 'none'} with ground truth"),
        ("Copies", words.counted_once(copies) if copies else ""),
        ("Participants", people(results, counts)),
        ("Method", "; ".join(filter(None, method))),
        ("Trained", trained(results)),
        ("In papers", said_by_papers and f"{said_by_papers} {WORDS}: see Statistics"),
        ("The paper", reason and f"no check of its scores: {reason}"),
    ]
    return [(term, text) for term, text in found if text]


def trained(results: Shown) -> str:
    """Describes training; models trained alike share an entry."""
    alike: dict[str, list[str]] = {}
    for model, how in results.trained.items():
        alike.setdefault(how, []).append(model)
    return "; ".join(f"{', '.join(models)}: {how}" for how, models in alike.items())


def other_data(results: Shown) -> str:
    """Reason why scores cannot be compared with the paper's; empty if shapes and people are the paper's."""
    if results.simulated:
        return "the participants are simulated"
    if not results.record:
        return "run.yaml does not say of which data and protocol the scores are"
    layout = results.record.get("data_set", {}).get("layout", "")
    return (
        ""
        if layout in LAYOUTS
        else f"these are not the paper's data, but of the layout {layout or 'unknown'}"
    )


def people(results: Shown, counts: Mapping[str, int]) -> str:
    entry = results.record.get("data_set", {})
    layout = entry.get("layout", "")
    of = f", data set {layout}" if layout else ""
    if results.simulated:
        return f"simulated by the program{of}: nothing here is about people"
    scans = (
        "; scans have the ground truth of their mesh, nobody was asked about them"
        if "scans" in counts
        else ""
    )
    if results.has("gaze"):
        table = results.table("gaze")
        table = table[table["item"].isin(results.table("results")["item"])]
        included = (table["left_out"] == "").groupby(table["item"]).sum()
        entry = {**entry, "participants": [included.min(), included.max()] if len(included) else []}
    return f"{told_apart(entry)}{of}{scans}"


def told_apart(entry: Mapping[str, Any]) -> str:
    """Number of people per shape, if the files distinguish them."""
    if not entry.get("participants"):
        return "number unknown"
    few, many = map(int, entry["participants"])
    if many == 0:
        return "number unknown, pooled"
    if few == 0:
        return f"up to {many} participants per shape, pooled on some"
    return f"{'' if few == many else f'{few} to '}{several(many, 'participant')} per shape"
