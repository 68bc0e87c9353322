# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of the models: the paper's table 1, and every option."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from salbench.pages.blocks import Block, Cell, Fold
from salbench.pages.columns import Column, sheet, text
from salbench.report.results import Row, flatten
from salbench.report.report import Report
from salbench.system.csv import read_csv

PAPER = Path(__file__).parents[1] / "configs/paper/parameters.csv"  # typed from the paper, with its source


def parameters(report: Report) -> list[Block]:
    """Blocks with the paper's parameters and their values in each protocol; then every option of the
    models."""
    ours = report.results.option("protocol") or ""
    configuration = report.results.record.get("configuration")
    flat = {name: model_options(values) for name, values in protocols().items()}
    if configuration:
        own = model_options(configuration)
        if flat.get(ours) == own:
            del flat[ours]  # same as the run's own column
        flat = {f"this run ({ours})" if ours else "this run": own} | flat
    columns = [
        text("Model", "model"),
        text("Symbol", "symbol"),
        text("Paper", lambda row: f"{row['value']} {row['unit']}".strip()),
        text("Option", "option"),
    ]
    columns += [Column(name, partial(parameter_cell, values), numeric=False) for name, values in flat.items()]
    return [
        sheet(
            "parameters",
            (
                "Parameters of the models: the paper's, and the configuration's. R: radius of the bounding"
                " sphere."
            ),
            columns,
            read_csv(PAPER).to_dict("records"),
        ),
        all_options(flat),
    ]


def protocols() -> dict[str, dict[str, Any]]:
    """protocol -> its complete configuration, with scalars as text."""
    from salbench import _core

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    return {
        protocol: yaml.load(_core.protocol_configuration(protocol), loader)
        for protocol in ("published", "text")
    }


def parameter_cell(values: Mapping[str, str], row: Row) -> Cell:
    option, _, unless = row["unless"].partition("=")
    if option and values.get(option) == unless:
        return Cell("not used", below=f"{option}: {unless}")
    return Cell(f"{values[row['option']]} {row['unit']}".strip()) if row["option"] in values else Cell("–")


def all_options(flat: Mapping[str, Mapping[str, str]]) -> Fold:
    def show(options: Mapping[str, str], path: str) -> Cell:
        return Cell(options.get(path, "–"), bold=len({values.get(path, "–") for values in flat.values()}) > 1)

    columns = [text("Option", str)]
    columns += [Column(name, partial(show, options), numeric=False) for name, options in flat.items()]
    return Fold(
        "Every option",
        [
            sheet(
                "options",
                "Every option of models, descriptors and normals; bold where the columns differ.",
                columns,
                dict.fromkeys(path for values in flat.values() for path in values),
            )
        ],
    )


def model_options(configuration: Mapping[str, Any]) -> dict[str, str]:
    """Options that affect saliency maps, by path."""
    sections = ("models.", "fpfh.", "scan_fpfh.", "normals.", "scan_normals.", "surface.")
    return {path: value for path, value in flatten(configuration).items() if path.startswith(sections)}
