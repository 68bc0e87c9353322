# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says, typed into configs/paper/*.csv with its source; its numbers are in configs/published (conclusions/papers.py)."""

from pathlib import Path

from salbench.report.results import Shown

FOLDER = Path(__file__).parent.parent / "configs/paper"
LAYOUTS = ("schelling", "princeton", "gs")  # of SHREC'07 with the ground truth of the Schelling study


def other_data(results: Shown) -> str:
    """Why scores say nothing about the paper's; empty if they are of its shapes and people."""
    if results.simulated:
        return "the participants are simulated"
    if not results.record:
        return "run.yaml does not say of which data and protocol the scores are"
    layout = results.record.get("data_set", {}).get("layout", "")
    if layout not in LAYOUTS:
        return f"these are not the paper's data, but of the layout {layout or 'unknown'}"
    return ""
