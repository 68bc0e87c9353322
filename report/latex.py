# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of classes as a LaTeX file for \\input, with the package booktabs."""

from jinja2 import Environment

_SPECIAL = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
            "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}",
            '"': "''"}

_TEMPLATE = """\
% {{ label }} per class on {{ dataset }}: mean and half of the 95 % interval; needs \\usepackage{booktabs}
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


def escape(text):
    return "".join(_SPECIAL.get(character, character) for character in str(text))


def number(row, bold):
    if row is None or row["mean"] != row["mean"]:
        return "--"
    spread = rf" \pm {row['ci95']:.2f}" if row["ci95"] == row["ci95"] else ""
    value = f"{row['mean']:.2f}{spread}"
    return rf"$\mathbf{{{value}}}$" if bold else f"${value}$"


def write_per_class(path, classes, models, by_cell, best, metric, dataset, simulated):
    """by_cell: (class, model or "Avg") -> a row with mean and ci95. best: class -> its best models."""
    rows = []
    for name in classes:
        cells = [number(by_cell.get((name, model)), model in best[name]) for model in models]
        rows.append((name, cells + [number(by_cell.get((name, "Avg")), False)]))
    environment = Environment(trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True, autoescape=False)
    environment.filters["tex"] = escape
    text = environment.from_string(_TEMPLATE).render(rows=rows, models=models, label=escape(metric.label), dataset=dataset,
                                                     simulated=simulated)
    path.write_text(text, encoding="utf-8")
