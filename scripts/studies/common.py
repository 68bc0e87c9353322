# SPDX-License-Identifier: GPL-3.0-or-later
# Imported by the other files of this folder.
"""The program and the package behind the figures, and output of figures to pages."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(ROOT / "build/release/salbench"))
sys.path.append(str(ROOT / "build/release/python"))  # fallback behind PYTHONPATH

from salbench.runs.tables import read  # noqa: E402


def ran(command, config, data, cache, *more):
    """Runs the program quietly. Failed items (exit status 1) show in the tables."""
    status = subprocess.run(
        [PROGRAM, command, config, "--data", data, "--cache", cache, "--quiet", *more],
        stderr=subprocess.DEVNULL,
    ).returncode
    if status not in (0, 1):
        sys.exit(f"scripts/figures: salbench {command} {config}: exit status {status}")


def results(out):
    return read(out / "results.csv")


def markdown(head, rows):
    return (
        "\n".join("| " + " | ".join(row) + " |" for row in (head, *rows)).replace(
            "\n", "\n" + "|---" * len(head) + "|\n", 1
        )
        + "\n"
    )


def show(text, page, figures, write):
    """Prints a text. If `write`, it also replaces the part between the markers of these figures in a page of
    docs/."""
    print(text, end="")
    if write:
        begin, end = marks(figures)
        before, rest = page.read_text(encoding="utf-8").split(begin)
        page.write_text(before + begin + text + end + rest.partition(end)[2], encoding="utf-8")


def marks(figures):
    return f"<!-- scripts/figures {figures}: begin -->\n", "<!-- end -->\n"
