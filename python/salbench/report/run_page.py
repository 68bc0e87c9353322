# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the run itself: what it was over, what it did, what failed, where time and space went."""

from typing import Any

import numpy
import pandas

from salbench.pages.blocks import Block, Cell, Missing, Note, Plot, Table, attempt, cell, count
from salbench.report.drawing import Drawing
from salbench.report.results import Frame, flatten, number_of
from salbench.report.workshop import Workshop

MOST_INTERVALS = 100_000  # of a timeline; the program writes a thousand at most
FACTS = ("program", "results", "threads", "seconds", "artefacts_computed", "peak_memory_mb", "shard", "reference")


def blocks(shop: Workshop) -> list[tuple[str, list[Block]]]:
    """(title, blocks) of each section."""
    return [("Facts", attempt(facts, shop)), ("Failed items", attempt(failures, shop)),
            ("What was computed, and why", attempt(stages, shop)), ("Time per stage", attempt(nodes, shop)),
            ("Timeline of the cores", attempt(timeline, shop)), ("Size of the cache", attempt(cache, shop)),
            ("Configuration", attempt(configuration, shop))]


def known_record(shop: Workshop) -> dict[str, Any]:
    if not shop.results.record:
        raise Missing("run.yaml is missing, cannot be read, or was not completed: the run was ended before its end.")
    return shop.results.record


def facts(shop: Workshop) -> Table:
    record = known_record(shop)
    lines = {key: record[key] for key in FACTS if record.get(key)}
    for key in ("data_set", "evaluated"):
        lines |= {f"{key}: {name}": value if isinstance(value, str) else " to ".join(value) for name, value in record.get(key, {}).items()}
    for key in ("protocol", "seed"):
        if chosen := shop.results.option(key):
            lines[key] = chosen
    if "peak_memory_mb" not in lines:
        lines["peak_memory_mb"] = "not recorded: an older version of the program wrote run.yaml"
    return Table("facts", "The run, as recorded in run.yaml.", ["What", "Value"],
                 [[Cell(name.replace("_", " ")), Cell(value)] for name, value in lines.items()], [False, False])


def failures(shop: Workshop) -> Block:
    known_record(shop)
    rows = [[Cell(text) for text in entry.values()] for entry in shop.results.failed]
    if not rows:
        return Note("No item failed.")
    return Table("failed", f"{len(rows)} jobs failed; the others went on without them.", ["Item", "Stage", "Cause"], rows,
                 [False] * 3, filters=[1])


def stages(shop: Workshop) -> Table:
    """Per stage what was computed and why; everything else came from the cache."""
    found = known_record(shop).get("stages")
    if not found:
        raise Missing("run.yaml does not say why stages were computed.")
    rows = []
    for stage, entry in found.items():
        reasons = "; ".join(f"{reason}: {n}" for reason, n in entry.get("why", {}).items())
        rows.append([Cell(stage), count(number_of(entry.get("version"))), Cell(reasons or "nothing: all from the cache")])
    return Table("stages", "Versions of the stages, and why this run computed what it did (counts of jobs).",
                 ["Stage", "Version", "Computed because"], rows, [False, True, False])


def node_table(shop: Workshop) -> Frame:
    nodes = known_record(shop).get("nodes")
    if not nodes:
        raise Missing("run.yaml holds no nodes.")
    table = pandas.DataFrame(nodes)
    for column in ("items", "settled", "computed", "seconds", "median", "p95", "busy"):
        table[column] = table[column].map(number_of) if column in table else float("nan")
    return table


def nodes(shop: Workshop) -> list[Block]:
    table = node_table(shop)
    rows = []
    for row in table.to_dict("records"):
        cached = row["items"] - row["computed"]
        rows.append([Cell(str(row.get("stage", ""))), Cell(str(row.get("of", ""))), count(row["items"]),
                     count(row["computed"]), count(max(cached, 0) if cached == cached else cached),
                     cell(row["seconds"], 2), cell(row["median"], 4), cell(row["p95"], 4), cell(100 * row["busy"], 1)])
    listing = Table("nodes", "Nodes of the flow graph. Not computed: found in the cache, not needed, or failed.",
                    ["Stage", "Of", "Jobs", "Computed", "Not computed", "Seconds", "Median s", "95th percentile s",
                     "Share of the cores %"], rows, [False, False] + [True] * 7, filters=[1])
    worked = table[table["seconds"] > 0].groupby("stage", sort=False)["seconds"].sum().sort_values()
    if worked.empty:
        return [Note("Nothing was computed: everything was found in the cache."), listing]
    data = worked.rename("seconds").reset_index()
    longest = ", ".join(f"{row.stage} {row.seconds:.1f} s" for row in data.iloc[::-1].head(5).itertuples())
    return [shop.plot("stages", Drawing(draw_stages, (data,), (9, 0.3 * len(data) + 1)), data, f"Time per stage, longest first: {longest}.",
                      "Time that the run spent per stage, over all shapes."), listing]


def draw_stages(figure: Any, data: Frame) -> None:
    axes = figure.subplots()
    axes.barh(data["stage"], data["seconds"], color="#0072B2", height=0.65)
    axes.set(xlabel="Seconds of all cores")
    axes.grid(axis="y", visible=False)


# At least 3:1 beside white, as hatches tell them apart in grey.
AREAS = (("#0072B2", ""), ("#D55E00", "////"), ("#009E73", "...."), ("#BF5F96", "\\\\\\\\"), ("#A87400", "xxx"), ("#5E3C99", "---"),
         ("#8B4513", "|||"), ("#767676", "++"))


def draw_timeline(figure: Any, shown: Frame, width: float, end: float, most: float) -> None:
    """shown: cores at work per stage in each interval of this width."""
    axes = figure.subplots()
    ends = numpy.arange(len(shown) + 1) * width  # the last interval is drawn to its end
    heights = numpy.vstack([shown.to_numpy(), shown.to_numpy()[-1:]])
    areas = axes.stackplot(ends, heights.T, labels=shown.columns, colors=[colour for colour, _ in AREAS], step="post", lw=0.4, edgecolor="#333333")
    for area, (_, hatch) in zip(areas, AREAS):
        area.set_hatch(hatch)
    axes.set(xlabel="Seconds since the start", ylabel="Cores at work", xlim=(0, end), ylim=(0, most * 1.02))
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=9)


def timeline(shop: Workshop) -> Plot:
    """Cores at work over the time of the run, by stage."""
    columns = ("start", "end", "node", "busy")
    try:
        table = shop.results.table("timeline.csv", *columns)
    except Missing as reason:
        raise Missing(f"{reason} Versions of the program from before the report do not write it.") from None
    width = (table["end"] - table["start"]).max()
    if table.empty or not width > 0:
        raise Missing("timeline.csv holds no interval: nothing was computed.")
    table = table.dropna(subset=["start", "end", "busy"])
    table = table[table["end"] > table["start"]]
    if table["end"].max() > MOST_INTERVALS * width:
        raise Missing("timeline.csv cannot be drawn: its intervals are too short for its end.")
    cores = (table["busy"] / (table["end"] - table["start"])).rename("cores")
    wide = table.assign(cores=cores).pivot_table(index="start", columns="node", values="cores", aggfunc="sum").fillna(0)
    largest = wide.sum().sort_values(ascending=False, kind="stable").index
    shown = wide[largest[:7]].assign(**({"others": wide[largest[7:]].sum(axis=1)} if len(largest) > 7 else {}))
    starts = numpy.round(numpy.arange(0, table["end"].max() - width / 2, width) / width).astype(int)
    shown.index = numpy.round(shown.index / width).astype(int)
    shown = shown.groupby(level=0).sum().reindex(starts, fill_value=0.0)
    most = max(number_of(shop.results.record.get("threads"), 1), shown.sum(axis=1).max())
    drawing = Drawing(draw_timeline, (shown, float(width), float(table["end"].max()), float(most)), (11, 3.6))
    data = shown.rename_axis("start").reset_index()
    data["start"] *= width
    mean = shown.to_numpy().sum(axis=1).mean()
    return shop.plot("timeline", drawing, data, f"On average {mean:.2f} cores were at work; most of the time went to "
                     f"{', '.join(largest[:3])}.", "Cores at work over the time of the run, by stage.")


def cache(shop: Workshop) -> Table:
    sizes = known_record(shop).get("cache_bytes")
    if not sizes:
        raise Missing("run.yaml does not say how large the cache is: an older version of the program wrote it.")
    total = sum(number_of(size, 0) for size in sizes.values())
    rows = [[Cell(stage), cell(number_of(size) / 1e6, 2), cell(100 * number_of(size) / total if total else 0, 1)]
            for stage, size in sorted(sizes.items(), key=lambda entry: -number_of(entry[1], 0))]
    return Table("cache", f"Size of the cache per stage, {total / 1e6:.1f} MB in all.", ["Stage", "MB", "Share %"], rows,
                 [False, True, True])


def configuration(shop: Workshop) -> Table:
    found = known_record(shop).get("configuration")
    if not found:
        raise Missing("run.yaml holds no configuration.")
    return Table("configuration", "The complete configuration, as the program understood it.", ["Option", "Value"],
                 [[Cell(path), Cell(value)] for path, value in flatten(found).items()], [False, False])
