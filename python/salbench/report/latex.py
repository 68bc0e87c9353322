# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as LaTeX files for \\input, with the package booktabs."""

from collections.abc import Mapping, Sequence
from typing import Any

from jinja2 import Environment

from salbench.report.metrics import Metric
from salbench.report.results import Row

_SPECIAL = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
            "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}",
            '"': "''"}

_TEMPLATE = """\
% {{ label }} per class on {{ dataset }}: mean and half of the 95 % interval, or its ends; needs \\usepackage{booktabs}
{% if simulated %}% SIMULATED participants: these scores say nothing about people.
{% endif %}
\\begin{tabular}{l{{ "c" * (models|length + 1) }}}
\\toprule
Class{% for model in models %} & {{ model|tex }}{% endfor %} & Avg-{{ label }} \\\\
\\midrule
{% for name, cells in rows %}
\\emph{ {{- (name or "(no class)")|tex -}} }{% for cell in cells %} & {{ cell }}{% endfor %} \\\\
{% endfor %}
\\bottomrule
\\end{tabular}
"""


_COMPACT = """\
% {{ dataset }}, {{ over }}: mean and half of the 95 % interval, or its ends; best in bold; models without a letter in common differ;
% needs \\usepackage{booktabs}
{% if simulated %}% SIMULATED participants: these scores say nothing about people.
{% endif %}
{% for model, n in failed.items() %}
% \\dag: {{ model|tex }} has no score on {{ n }} shapes; all models are compared on those that every one has
{% endfor %}
\\begin{tabular}{l{{ "c" * heads|length }}}
\\toprule
Model{% for label, arrow in heads %} & {{ label|tex }} $\\{{ arrow }}${% endfor %} \\\\
\\midrule
{% for model, cells in rows %}
{{ model|tex }}{% if model in failed %}\\textsuperscript{\\dag}{% endif %}{% for cell in cells %} & {{ cell }}{% endfor %} \\\\
{% endfor %}
\\bottomrule
\\end{tabular}
"""


def escape(text: object) -> str:
    return "".join(_SPECIAL.get(character, character) for character in str(text))


def number(row: Row | None, bold: bool) -> str:
    if row is None or row["mean"] != row["mean"]:
        return "--"
    value = f"{row['mean']:.2f}{spread(row, 2)}"
    return rf"$\mathbf{{{value}}}$" if bold else f"${value}$"


def per_class(classes: Sequence[str], models: Sequence[str], by_cell: Mapping[tuple[str, str], Row], best: Mapping[str, set[str]],
                    metric: Metric, dataset: str, simulated: bool) -> str:
    """by_cell: (class, model or "Avg") -> a row with mean and ci95. best: class -> its best models."""
    rows = []
    for name in classes:
        cells = [number(by_cell.get((name, model)), model in best[name]) for model in models]
        rows.append((name, cells + [number(by_cell.get((name, "Avg")), False)]))
    return render(_TEMPLATE, rows=rows, models=models, label=escape(metric.label), dataset=dataset, simulated=simulated)


def compact(models: Sequence[str], metrics: Sequence[Metric], by_cell: Mapping[tuple[str, str], Row], failed: Mapping[str, int],
                  dataset: str, over: str, simulated: bool) -> str:
    """by_cell: (model, metric) -> a row of compact.csv. failed: model -> number of shapes without a score."""
    rows = [(model, [compact_number(by_cell.get((model, metric.name))) for metric in metrics]) for model in models]
    heads = [(metric.label, "downarrow" if metric.lower else "uparrow") for metric in metrics]
    return render(_COMPACT, rows=rows, heads=heads, failed=failed, dataset=dataset, over=over, simulated=simulated)


def compact_number(row: Row | None) -> str:
    if row is None or row["mean"] != row["mean"]:
        return "--"
    value = f"{row['mean']:.3f}{spread(row, 3)}"
    group = rf"^{{\mathrm{{{row['group']}}}}}" if row["group"] else ""
    return rf"$\mathbf{{{value}}}{group}$" if row["best"] == 1 else f"${value}{group}$"


def spread(row: Row, digits: int) -> str:
    """Half of the interval, or its ends where these are not equally far from the mean."""
    if row["half"] == row["half"]:
        return rf" \pm {row['half']:.{digits}f}"
    return rf"\,({row['low']:.{digits}f},\,{row['high']:.{digits}f})" if row["low"] == row["low"] else ""


def render(template: str, **values: Any) -> str:
    environment = Environment(trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True, autoescape=False)
    environment.filters["tex"] = escape
    return environment.from_string(template).render(**values)
