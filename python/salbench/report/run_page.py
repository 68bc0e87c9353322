# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the run itself: its data, jobs, failures, time and space."""

from collections.abc import Mapping
from typing import Any

import pandas

from salbench.pages.blocks import Block, Missing, Note, Table, cell, count
from salbench.pages.columns import Column, counted, number, sheet, text
from salbench.report.drawing import Drawing
from salbench.report.front import told_apart
from salbench.report.results import Frame, flatten, number_of
from salbench.report.report import Report
from salbench.runs.failed import kind_of

COLOURS = ("#0072B2", "#D55E00", "#009E73")  # contrast of at least 3:1 with white
ITEMS = 5  # listed by name if they failed alike
FACTS = (
    "program",
    "results",
    "threads",
    "seconds",
    "artefacts_computed",
    "peak_memory_mb",
    "shard",
    "reference",
)


def facts(report: Report) -> Table:
    record = report.results.record
    lines = {key: record[key] for key in FACTS if record.get(key)}
    data_set = record.get("data_set", {})
    lines |= {
        f"data_set: {name}": told_apart(data_set) if name == "participants" else value
        for name, value in data_set.items()
    }
    for given in report.results.given_maps:
        lines |= {
            f"evaluated: {given['model']}: {name}": value for name, value in given.items() if name != "model"
        }
    for key in ("protocol", "seed"):
        if chosen := report.results.option(key):
            lines[key] = chosen
    if "peak_memory_mb" not in lines:
        lines[
            "peak_memory_mb"
        ] = "not recorded: an older version of the program wrote run.yaml, or there was no /proc"
    columns = [text("What", lambda line: line[0].replace("_", " ")), text("Value", lambda line: line[1])]
    return sheet("facts", "The run, as recorded in run.yaml.", columns, lines.items())


def failures(report: Report) -> Block:
    failed = report.results.failed_jobs
    if not failed:
        return Note("No item failed.")
    alike: dict[tuple[str, str], list[dict[str, str]]] = {}
    for job in failed:
        alike.setdefault((job["stage"], kind_of(job["cause"], job["item"])), []).append(job)
    rows = [
        {
            **jobs[0],
            "n": len(jobs),
            "items": ", ".join([job["item"] for job in jobs[:ITEMS]] + ["..."] * (len(jobs) > ITEMS)),
        }
        for jobs in alike.values()
    ]
    return sheet(
        "failed",
        (
            f"{len(failed)} jobs failed; the others went on without them. Jobs of a stage that failed alike"
            " share a row."
        ),
        [text("Stage", "stage"), counted("Jobs", "n"), text("Items", "items"), text("Cause", "cause")],
        rows,
        ["Stage"],
    )


def stages(report: Report) -> Table:
    """Computed jobs per stage, with reasons; everything else came from the cache."""
    found = report.results.record.get("stages")
    if not found:
        raise Missing("run.yaml does not say why stages were computed.")

    def reasons(line: tuple[str, Mapping[str, Any]]) -> str:
        return (
            "; ".join(f"{reason}: {n}" for reason, n in line[1].get("why", {}).items())
            or "nothing: all from the cache"
        )

    columns = [
        text("Stage", lambda line: line[0]),
        Column("Version", lambda line: count(number_of(line[1].get("version")))),
        text("Computed because", reasons),
    ]
    return sheet(
        "stages",
        "Versions of the stages, and why this run computed what it did (counts of jobs).",
        columns,
        found.items(),
    )


def node_table(report: Report) -> Frame:
    nodes = report.results.record.get("nodes")
    if not nodes:
        raise Missing("run.yaml holds no nodes.")
    table = pandas.DataFrame(nodes)
    for column in ("items", "settled", "computed", "seconds", "median", "p95", "busy"):
        table[column] = table[column].map(number_of) if column in table else float("nan")
    return table


def nodes(report: Report) -> list[Block]:
    table = node_table(report)
    table["others"] = (table["items"] - table["computed"]).clip(lower=0)
    columns = [
        text("Stage", lambda row: str(row.get("stage", ""))),
        text("Of", lambda row: str(row.get("of", ""))),
        counted("Jobs", "items"),
        counted("Computed", "computed"),
        counted("Not computed", "others"),
        number("Seconds", "seconds", 2),
        number("Median s", "median", 4),
        number("95th percentile s", "p95", 4),
        Column("Share of the cores %", lambda row: cell(100 * row["busy"], 1)),
    ]
    listing = sheet(
        "nodes",
        "Nodes of the flow graph. Not computed: found in the cache, not needed, or failed.",
        columns,
        table.to_dict("records"),
        ["Of"],
    )
    worked = table[table["seconds"] > 0].groupby("stage", sort=False)["seconds"].sum().sort_values()
    if worked.empty:
        return [Note("Nothing was computed: everything was found in the cache."), listing]
    data = worked.rename("seconds").reset_index()
    longest = ", ".join(f"{row.stage} {row.seconds:.1f} s" for row in data.iloc[::-1].head(5).itertuples())
    return [
        report.plot(
            "stages",
            Drawing(draw_stages, (data,), (9, 0.3 * len(data) + 1)),
            data,
            f"Time per stage, longest first: {longest}.",
            "Time that the run spent per stage, over all shapes.",
        ),
        listing,
    ]


def draw_stages(figure: Any, data: Frame) -> None:
    axes = figure.subplots()
    axes.barh(data["stage"], data["seconds"], color="#0072B2", height=0.65)
    axes.set(xlabel="Seconds of all cores")
    axes.grid(axis="y", visible=False)


def costs(report: Report) -> list[Block]:
    """Median and 95th percentile of seconds per map of each model."""
    kinds = ["dataset", "model"]
    of = report.results.table("costs").groupby(kinds, sort=False)
    own = of["seconds"].quantile([0.5, 0.95]).unstack().set_axis(["median", "p95"], axis=1)
    table = own.assign(
        maps=of["seconds"].count(),
        processor=of["processor_seconds"].median(),
        inputs=of["input_seconds"].median(),
    ).reset_index()
    columns = [
        text("Of", "dataset"),
        text("Model", "model"),
        counted("Maps", "maps"),
        number("Median s", "median", 4),
        number("95th percentile s", "p95", 4),
        number("Median processor s", "processor", 4),
        number("Median s of inputs", "inputs", 4),
    ]
    listing = sheet(
        "costs",
        (
            "What maps took when they were computed, on whatever machine that was, from the cache. It is no"
            " part of any ranking. Inputs are shared by models; processor time of commands and functions is"
            " not known."
        ),
        columns,
        table.to_dict("records"),
        ["Of"],
    )
    data = table.loc[table["median"] > 0, [*kinds, "median", "p95"]]
    if data.empty:
        return [
            Note("The cache does not say what its maps cost: an older version of the program computed them."),
            listing,
        ]
    slowest = data.sort_values("median", ascending=False, kind="stable").iloc[0]
    return [
        report.plot(
            "costs",
            Drawing(draw_costs, (data,), (9, 0.3 * data["model"].nunique() + 1.2)),
            data,
            f"Slowest in the median: {slowest['model']} on {slowest['dataset']}, {slowest['median']:.2g} s.",
            "Seconds per map: the median and the 95th percentile of each model.",
        ),
        listing,
    ]


def draw_costs(figure: Any, data: Frame) -> None:
    axes = figure.subplots()
    models, datasets = list(dict.fromkeys(data["model"]))[::-1], list(dict.fromkeys(data["dataset"]))
    for k, (dataset, colour) in enumerate(zip(datasets, COLOURS)):
        rows = data[data["dataset"] == dataset]
        places = rows["model"].map(models.index) - 0.25 * (k - (len(datasets) - 1) / 2)
        axes.hlines(places, rows["median"], rows["p95"], color=colour, lw=1.5)
        axes.plot(rows["median"], places, "osD"[k % 3], color=colour, ms=5, label=dataset)
    axes.set(xscale="log", xlabel="Seconds per map", yticks=range(len(models)), yticklabels=models)
    axes.grid(axis="y", visible=False)
    if len(datasets) > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=9)


def cache(report: Report) -> Table:
    sizes = report.results.record.get("cache_bytes")
    if not sizes:
        raise Missing(
            "run.yaml does not say how large the cache is: an older version of the program wrote it."
        )
    total = sum(number_of(size, 0) for size in sizes.values())
    rows = [
        (stage, number_of(size))
        for stage, size in sorted(sizes.items(), key=lambda entry: -number_of(entry[1], 0))
    ]
    columns = [
        text("Stage", lambda row: row[0]),
        Column("MB", lambda row: cell(row[1] / 1e6, 2)),
        Column("Share %", lambda row: cell(100 * row[1] / total if total else 0, 1)),
    ]
    return sheet("cache", f"Size of the cache per stage, {total / 1e6:.1f} MB in all.", columns, rows)


def configuration(report: Report) -> Table:
    found = report.results.record.get("configuration")
    if not found:
        raise Missing("run.yaml is missing or unreadable, or holds no configuration.")
    return sheet(
        "configuration",
        "The complete configuration, as the program understood it.",
        [text("Option", lambda line: line[0]), text("Value", lambda line: line[1])],
        flatten(found).items(),
    )
