# SPDX-License-Identifier: GPL-3.0-or-later
r"""Tables of pages as LaTeX files for \input, with the package booktabs."""

from collections.abc import Sequence

from salbench.pages.blocks import Cell, Table
from salbench.report.results import Row
from salbench.report.report import Report

_SPECIAL = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "|": r"\textbar{}",
        '"': "''",
        "−": "$-$",
        "–": "--",
        "†": r"\dag{}",
        "±": r"$\pm$",
    }
)
_ARROWS = {"higher": r" $\uparrow$", "lower": r" $\downarrow$", "": ""}


def escape(text: str) -> str:
    return text.translate(_SPECIAL)


def number(row: Row | None, digits: int, bold: bool, group: str = "") -> str:
    """Formats a row with mean, half, low and high: the mean with half of its interval, or with both ends if
    the interval is asymmetric."""
    if row is None or row["mean"] != row["mean"]:
        return "--"
    low, high, half = (f"{row[name]:.{digits}f}" for name in ("low", "high", "half"))
    spread = (
        rf" \pm {half}"
        if row["half"] == row["half"]
        else rf"\,({low},\,{high})"
        if row["low"] == row["low"]
        else ""
    )
    value = f"{row['mean']:.{digits}f}{spread}"
    return (
        "$"
        + (rf"\mathbf{{{value}}}" if bold else value)
        + (rf"^{{\mathrm{{{group}}}}}" if group else "")
        + "$"
    )


def document(table: Table, remarks: Sequence[str], without: Sequence[str] = ()) -> str:
    """Formats the table as a tabular, with remarks above it. without: heads of columns to leave out."""
    kept = [at for at, head in enumerate(table.columns) if head not in without]
    better = table.better or [""] * len(table.columns)

    def line(texts: Sequence[str]) -> str:
        return " & ".join(texts) + r" \\"

    def cells(row: Sequence[Cell]) -> str:
        return line([row[at].tex or escape(row[at].text or row[at].badge[0]) for at in kept])

    return "\n".join(
        [
            *(f"% {remark}" for remark in remarks),
            r"\begin{tabular}{l" + "c" * (len(kept) - 1) + "}",
            r"\toprule",
            line([escape(table.columns[at]) + _ARROWS[better[at]] for at in kept]),
            r"\midrule",
            *map(cells, table.rows),
            r"\bottomrule",
            r"\end{tabular}",
            "",
        ]
    )


def beside(report: Report, table: Table, remarks: Sequence[str], without: Sequence[str] = ()) -> Table:
    """Returns the table, linked to its LaTeX file."""
    path = f"data/{table.id}.tex"
    simulated = (
        ["SIMULATED participants: these scores say nothing about people."] if report.results.simulated else []
    )
    report.folder.write(
        path, document(table, [*remarks, r"needs \usepackage{booktabs}", *simulated], without)
    )
    table.files.insert(0, ("LaTeX", path))
    return table
