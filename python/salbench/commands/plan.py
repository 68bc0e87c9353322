# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench plan`: prints the jobs of a run with reasons, for all stages or those of one item; and its flow
graph."""

import argparse
import os
from typing import TYPE_CHECKING, Any

from salbench.commands.parsing import Parser
from salbench.commands.running import settings_of
from salbench.system.console import ALL_DONE, aligned, report
from salbench.system.errors import InputError, arguments_refused

if TYPE_CHECKING:
    from salbench import _core

Rows = list[dict[str, Any]]
_COUNTS = ("cached", "to_compute", "waiting", "not_applicable", "failed", "artefacts")


def add_arguments(parser: Parser) -> None:
    parser.add_planning()
    parser.add_argument(
        "item",
        metavar="ITEM",
        nargs="?",
        default="",
        help="a mesh or point cloud (52), or a scan of a mesh (52_3): show its stages instead of counts",
    )
    parser.add_argument(
        "stage",
        metavar="STAGE",
        nargs="?",
        default="",
        help="only this stage of the item, and differences of its recipe from cached ones",
    )
    parser.add_output()
    parser.add_argument(
        "--graph",
        action="store_true",
        help=(
            "show the flow graph instead of counts: a node per rule, its inputs, and its open "
            "jobs if there is a data set"
        ),
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help=("also a row for each cached stage of other configurations (default: one line for all)"),
    )
    parser.add_report(forms=("text", "json", "dot"), further=", or dot for Graphviz (with --graph)")
    for name, other in (("--out", "--graph"), ("ITEM", "--graph"), ("ITEM", "--all")):
        parser.add_rule(name, "excludes", other)


def carry_out(given: argparse.Namespace) -> int:
    from salbench import _core

    if given.format == "dot" and not given.graph:
        raise InputError("--format dot: only a graph has that form; give --graph, too")
    settings = settings_of(given, given.config, out=given.out, shard=given.shard)
    with arguments_refused():
        if given.graph:
            _report_graph(given, _core.plan_graph(settings))
        elif given.item:
            _report_item(given, _core.Planned(settings, []).item(os.fsencode(given.item), given.stage))
        else:
            _report_counts(given, _core.Planned(settings, []))
    return ALL_DONE


# --- counts


def _report_counts(given: argparse.Namespace, planned: "_core.Planned") -> None:
    rows, summary = planned.rows(), planned.summary()
    n_shown = len(rows) if given.all else planned.own_rows
    last = f"last run: {summary['last_run']}\n" if summary["last_run"] else ""
    text = (
        f"{_table_text(rows[:n_shown])}\n{_others_text(rows[n_shown:])}data set: {planned.inputs_text},"
        f" {summary['models']} models; cache: {summary['cache']}\n{last}results:"
        f" {summary['results']}\n{summary['open']} jobs to"
        f" do{'; a waiting job is skipped if its input turns out unchanged' if summary['open'] else ''}\n"
    )
    report(given, "plan", {"stages": rows, **summary}, text)


def _table_text(rows: Rows) -> str:
    columns = (
        "stage",
        "cached",
        "to compute",
        "waiting",
        "not applicable",
        "failed",
        "in the cache",
        "MB",
        "why",
    )
    return aligned(
        columns,
        [
            (
                row["stage"],
                *(row[key] for key in _COUNTS),
                row["bytes"] / 1e6,
                "; ".join(f"{reason['why']}: {reason['jobs']}" for reason in row["reasons"]),
            )
            for row in rows
        ],
        decimals=1,
    )


def _others_text(rows: Rows) -> str:
    """Line on further artefacts in the cache."""
    if not rows:
        return ""
    artefacts, megabytes = sum(row["artefacts"] for row in rows), sum(row["bytes"] for row in rows) / 1e6
    return (
        f"also in the cache, of no stage of this configuration: {artefacts} artefacts, {megabytes:.1f} MB, of"
        f" {', '.join(row['stage'] for row in rows)} (--all lists them)\n"
    )


# --- one item


def _report_item(given: argparse.Namespace, found: dict[str, Any]) -> None:
    """Reports an item. For one stage also its key, and the lines by which its recipe differs from each cached
    one: "- before", "+ now"."""
    text = aligned(("stage", given.item, "why"), found["stages"])
    text += f"key {found['key']}\n" if found["key"] else ""
    for file, key, before, now in found["others"]:
        text += (
            f"{file}: key {key}\n"
            + "".join(f"  - {line}\n" for line in before)
            + "".join(f"  + {line}\n" for line in now)
        )
    stages = [{"stage": stage, "state": state, "why": why} for stage, state, why in found["stages"]]
    report(given, "item", {"item": given.item, "stages": stages}, text)


# --- the graph


def _report_graph(given: argparse.Namespace, nodes: Rows) -> None:
    report(
        given, "graph", {"nodes": nodes}, _dot_text(nodes) if given.format == "dot" else _graph_text(nodes)
    )


def _graph_text(nodes: Rows) -> str:
    """A line per node, and one for its options, grouped by level."""
    strata: dict[int, str] = {}
    for node in nodes:
        inputs = f" <- {', '.join(node['inputs'])}" if node["inputs"] else ""
        cuts = f"; read back: {', '.join(node['cuts'])}" if node["cuts"] else ""
        options = f"  {', '.join(node['options'])}\n" if node["options"] else ""
        strata[node["stratum"]] = (
            strata.get(node["stratum"], "") + f"{node['node']} (version {node['version']}, one per"
            f" {node['per']}{_to_do(node)}){inputs}{cuts}\n{options}"
        )
    return "\n".join(f"stratum {number + 1} of {len(strata)}\n{strata[number]}" for number in sorted(strata))


def _dot_text(nodes: Rows) -> str:
    lines, edges = "", ""
    for node in nodes:
        label = f"{node['stage']}\n{node['shapes']}, version {node['version']}{_to_do(node)}"
        shape = ", shape=ellipse" if node["per"] == "set" else ""
        tooltip = "\n".join(node["options"])
        lines += f"  {_quoted(node['node'])} [label={_quoted(label)}, tooltip={_quoted(tooltip)}{shape}];\n"
        for name in node["inputs"]:
            edges += (
                f"  {_quoted(name)} ->"
                f" {_quoted(node['node'])}{' [style=dashed]' if name in node['cuts'] else ''};\n"
            )
    return (
        'digraph salbench {\n  rankdir=LR;\n  node [shape=box, style=rounded,'
        f' fontname="sans-serif"];\n{lines}{edges}}}\n'
    )


def _to_do(node: dict[str, Any]) -> str:
    return "" if node["to_do"] is None else f", {node['to_do']} to do"


def _quoted(text: str) -> str:
    """A string of DOT. Labels are parsed for escapes and HTML entities, too."""
    for character, written in (("\\", "\\\\"), ('"', '\\"'), ("&", "&amp;"), ("\n", "\\n")):
        text = text.replace(character, written)
    return f'"{text}"'
