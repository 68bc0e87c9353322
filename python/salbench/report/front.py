# SPDX-License-Identifier: GPL-3.0-or-later
"""The first screen: who leads and how sure, how far the others are behind, what the letters mean, three shapes, and what the data is and is
not."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pandas

from salbench._core import models_about
from salbench.conclusions import glossary, words
from salbench.pages import dots
from salbench.pages.blocks import Missing, Note
from salbench.pages.dots import number
from salbench.pages.names import DATASETS, KIND_NAMES, several
from salbench.pages.reported import WORDS
from salbench.report import gallery, mine, paper, reported, statistics
from salbench.report.names import cut
from salbench.report.pages import Page, Pages
from salbench.report.painter import describe
from salbench.report.results import Shown
from salbench.report.workshop import Workshop

PANELS = 2   # data sets with panels; the page of the ranking has all
MODELS = 6   # rows of a panel, likewise
MOST_NAME = 8  # em of names beside each other


@dataclass
class Panel:
    """The best models of a data set by one metric: how far each is behind the best mean."""
    title: str
    better: str      # "higher" or "lower"
    rows: "list[Row]"
    axis: dots.Axis
    more: int = 0    # models that are left out


@dataclass
class Row:
    model: str
    name: str        # of it, as long as there is room
    mean: str
    group: str
    dot: dots.Dot | None


@dataclass
class Front:
    sentences: list[tuple[str, str]]  # (data set, who leads)
    models: list[tuple[str, str, str, str]] = field(default_factory=list)  # letters, what they mean, source, and its address
    metrics: list[tuple[str, str]] = field(default_factory=list)
    panels: list[tuple[str, list[Panel]]] = field(default_factory=list)  # (data set, [Panel])
    shapes: list[tuple[Any, ...]] = field(default_factory=list)  # (label, item, page, score, [(picture, alt)])
    shapes_said: str = ""
    facts: list[tuple[str, str]] = field(default_factory=list)  # (term, text)
    notes: list[Note] = field(default_factory=list)  # of what is missing

    @property
    def name_width(self) -> float:
        """Of the longest name, in em of bold letters."""
        names = (row.name for _, panels in self.panels for panel in panels for row in panel.rows)
        return max(3.4, round(0.68 * max(map(len, names), default=0), 1))

    @property
    def is_wide(self) -> bool:
        """Names leave no room for three panels in a row."""
        return self.name_width > MOST_NAME


def write_page(pages: Pages, page: Page) -> None:
    pages.write(page.path, "index.html", title=page.label, front=front(pages.shop), these=pages.shop.results.of_these, doors=pages.present[1:])


def front(shop: Workshop) -> Front:
    """Everything that index.html shows."""
    made = Front(sentences=[])
    for build in (add_sentences, add_letters, add_panels, add_shapes, add_facts):
        try:
            build(shop, made)
        except Missing as reason:
            note = Note(str(reason), missing=True)
            made.notes += [note] if note not in made.notes else []
    return made


def add_sentences(shop: Workshop, made: Front) -> None:
    for dataset in statistics.shown(shop.results):
        found = [brief(shop.results, dataset, metric) for metric in shop.results.leading]
        known = [of for of in found if of]
        if known:
            made.sentences.append((DATASETS[dataset], words.brief(known)))
        if shop.results.mine and (said := mine.sentence(shop.results, dataset)):
            made.sentences.append((shop.results.mine, said))


def brief(results: Shown, dataset: str, metric: str) -> words.Brief | None:
    """What leaders.csv says by a metric, of all splits together."""
    rows = statistics.leaders(results, dataset, metric)
    if rows.empty:
        return None
    return words.brief_of(rows.iloc[0], results.metric(metric).label, list(statistics.ranking(results, dataset, metric)["model"]))


def add_letters(shop: Workshop, made: Front) -> None:
    """A line per model and leading metric; of one's own models what run.yaml knows."""
    program = {name: models_about[name] for name in shop.models if name in models_about and name not in shop.results.evaluated}
    own = ((name, shop.results.told_of(name)) for name in shop.models if name not in program)
    made.models = [(name, about.name, about.source, about.link) for name, about in program.items()]
    made.models += [(name, said, "", "") for name, said in own if said]
    made.metrics = [(of.label, f"{glossary.compares(name)}; {glossary.range_of(name)}, {glossary.better(name)}")
                    for name, of in shop.results.leading.items() if glossary.compares(name)]


def add_panels(shop: Workshop, made: Front) -> None:
    for dataset in statistics.shown(shop.results):
        panels = []
        for metric in shop.results.leading:
            try:
                panels.append(panel(shop.results, dataset, metric, MODELS))
            except Missing:
                continue
        if panels and len(made.panels) < PANELS:
            made.panels.append((DATASETS[dataset], panels))
    if not made.panels:
        shop.results.table("compact")
        raise Missing("No shape has scores: there is nothing to compare.")


def panel(results: Shown, dataset: str, metric: str, most: int) -> Panel:
    of = results.metric(metric)
    ranked = statistics.ranking(results, dataset, metric)
    models = behind(results, dataset, metric)
    references = [one for one in models if one.model in dots.LINES]
    models = models[:len(models) - len(references)]
    shown = models[:most]
    shown[most - 1:] = [one for one in models[most - 1:] if one.model == results.mine] or shown[most - 1:]
    drawn, groups = dots.drawn([*shown, *references], first_of(results, dataset, metric), results.of_these), dict(zip(ranked["model"], ranked["group"]))
    rows = [Row(one.model, cut(one.model), number(one.mean), groups[one.model], drawn[one.model].dot) for one in shown]
    return Panel(of.label, "lower" if of.lower else "higher", rows, drawn[dots.AXIS].axis, len(models) - len(shown))


def behind(results: Shown, dataset: str, metric: str) -> list[dots.Behind]:
    """How far the models that pages show are behind the best."""
    ranking, compact = (of(results, dataset, metric).to_dict("records") for of in (statistics.ranking, statistics.compact))
    pairs = statistics.of_metric(results.table("significance"), dataset, metric).to_dict("records") if results.has("significance") else []
    found = dots.behind(ranking, pairs, compact, results.metric(metric).lower)
    if not found:
        raise Missing(f"ranking.csv ranks no model by {results.metric(metric).label}.")
    return found


def first_of(results: Shown, dataset: str, metric: str) -> list[str]:
    """Models that may be the best by a metric."""
    try:
        rows = statistics.leaders(results, dataset, metric)
    except Missing:
        return []
    return words.names_in(rows["leaders"].iloc[0]) if len(rows) else []


def add_shapes(shop: Workshop, made: Front) -> None:
    """The best, the median and the worst of the shapes with pictures, by the score of the leader, or of the best mean where none is named."""
    metric = next(iter(shop.results.leading))
    for dataset in statistics.shown(shop.results):
        leaders = [shop.results.mine] if shop.results.mine else first_of(shop.results, dataset, metric) or list(statistics.ranking(shop.results, dataset, metric)["model"])
        if not leaders:
            continue
        scores = statistics.scores(shop.results, dataset, metric).get(leaders[0], pandas.Series(dtype=float)).dropna()
        painters = [painter for painter in gallery.scored_pictures(shop, dataset)
                    if (painter.shape.item, painter.shape.view) in scores.index and painter.has(leaders[0])]
        if painters:
            break
    else:
        return
    of = shop.results.metric(metric)
    painters.sort(key=lambda painter: float(scores[painter.shape.item, painter.shape.view]), reverse=not of.lower)
    chosen = dict(zip((0, (len(painters) - 1) // 2, len(painters) - 1), ("Best", "Typical", "Worst")))
    for at, label in chosen.items():
        shape = painters[at].shape
        pictures = [(painters[at].paint(what), alt) for what, alt in
                    (("ground truth", f"What people marked on {shape.name}"), (leaders[0], f"Map of {leaders[0]} on {shape.name}"))]
        score = f"{of.label} {number(scores[shape.item, shape.view])}"
        made.shapes.append((label, describe(shape), shop.page_of(shape.item), score, [pair for pair in pictures if pair[0]]))
    kind = KIND_NAMES[dataset]
    made.shapes_said = (f"{leaders[0]} on its best, median and worst {kind} by {of.label}, of {len(painters)} with pictures: "
                        f"{'the simulated ground truth' if shop.results.simulated else 'what people marked'}, and its map.")


def add_facts(shop: Workshop, made: Front) -> None:
    """What the data is, and what it is not."""
    results = shop.results
    rows = results.table("results")
    counts = rows.drop_duplicates(["dataset", "item", "view"])["dataset"].value_counts()
    shapes = ", ".join(several(counts[name], KIND_NAMES[name]) for name in DATASETS if name in counts) or "none"
    made.facts.append(("Shapes", f"{shapes} with ground truth"))
    made.facts.append(("Participants", people(results, counts)))
    protocol = results.option("protocol")
    unit = {"mesh": "a mesh", "class": "a class of shapes", "shape": "a mesh, scan or point cloud"}.get(results.unit)
    said = [f"protocol {protocol}" if protocol else "", f"one observation is {unit}" if unit else "", "intervals are 95 %"]
    made.facts.append(("Method", "; ".join(filter(None, said))))
    if results.trained:
        made.facts.append(("Trained", "; ".join(f"{model}: {how}" for model, how in results.trained.items())))
    if said_by_papers := reported.said(results):
        made.facts.append(("In papers", f"{said_by_papers} {WORDS}: see Statistics"))
    reason = paper.other_data(results)
    if reason:
        made.facts.append(("Not", f"a check of the paper: {reason}"))


def people(results: Shown, counts: Mapping[str, int]) -> str:
    entry = results.record.get("data_set", {})
    layout = entry.get("layout", "")
    of = f", data set {layout}" if layout else ""
    if results.simulated:
        return f"simulated by the program{of}: nothing here is about people"
    scans = "; scans have the ground truth of their mesh, nobody was asked about them" if "scans" in counts else ""
    return f"{told_apart(entry)}{of}{scans}"


def told_apart(entry: Mapping[str, Any]) -> str:
    """How many people there were per shape, as far as the files tell them apart."""
    if not entry.get("participants"):
        return "real people"
    few, many = map(int, entry["participants"])
    if many == 0:
        return "real people, pooled"
    if few == 0:
        return f"real people, up to {many} per shape, pooled on some"
    return f"{few if few == many else f'{few} to {many}'} real people per shape"
