# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says, typed into configs/paper/*.csv with its source; its numbers are in configs/published (conclusions/papers.py)."""

from pathlib import Path
from typing import Any

from salbench import _tables
from salbench.conclusions.metrics import PAPERS
from salbench.report.results import Frame, Results, flatten

FOLDER = Path(__file__).parent.parent / "configs/paper"
CLASSES = 20
LAYOUTS = ("schelling", "princeton", "gs")  # of SHREC'07 with the ground truth of the Schelling study
MODELS = ("LS", "CS", "PS", "MS", "HS", "RS")
# Options that scores depend on, beside those of the models.
OPTIONS = ("scan.", "normals.", "scan_normals.", "surface.", "fpfh.", "scan_fpfh.", "metrics.splits", "metrics.thresholds",
           "metrics.constant_nss", *(f"models.{model}." for model in MODELS))


def read(name: str) -> Frame:
    """A table of configs/paper: text, but for the column margin, which is NaN where there is none."""
    return _tables.read(FOLDER / name, lambda column: "float64" if column == "margin" else "str")


def other_data(results: Results) -> str:
    """Why scores say nothing about the paper's; empty if they are of its shapes and people."""
    if results.simulated:
        return "the participants are simulated"
    if not results.record:
        return "run.yaml does not say of which data and protocol the scores are"
    layout = results.record.get("data_set", {}).get("layout", "")
    if layout not in LAYOUTS:
        return f"these are not the paper's data, but of the layout {layout or 'unknown'}"
    return ""


def other_protocol(results: Results, protocols: dict[str, Any]) -> str:
    """Why the scores are not made as the paper's; empty if they are. protocols: as Workshop.protocols."""
    name = results.option("protocol")
    if name is None:
        return "run.yaml does not name the protocol"
    own, theirs = flatten(results.record["configuration"]), flatten(protocols.get(name, {}))
    changed = [f"{path} is {own[path]} and not {value}" for path, value in theirs.items()
               if path.startswith(OPTIONS) and own.get(path, value) != value]
    changed += [f"metrics.matching of {name} is {read} and not histogram" for name, metric in results.record.get("metrics", {}).items()
                if name in PAPERS and (read := metric.get("matching") or "histogram") != "histogram"]
    return f"this is not the paper's protocol: {', '.join(changed)}" if changed else ""
