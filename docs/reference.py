#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by scripts/docs: the pages that are made from the program. reference.py PROGRAM FOLDER"""

import re
import subprocess
import sys
from pathlib import Path

import salbench

DOCS = Path(__file__).resolve().parent


def output(*words):
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return done.stdout.replace(words[0], "salbench").rstrip() + "\n"


def fenced(text, language="text"):
    return f"```{language}\n{text.rstrip()}\n```\n"


def table(head, rows):
    def line(cells):
        return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"
    return "\n".join([line(head), "|" + "---|" * len(head), *map(line, rows)]) + "\n"


def commands(program):
    """The help of the program and of each subcommand, without what all of them end with."""
    whole = output(program, "--help")
    ending = whole[whole.index("\nExit status:"):]
    names = re.findall(r"^  ([a-z]+) ", whole[whole.index("Subcommands:"):whole.index("\nExamples:")], flags=re.M)
    pages = ["# Commands\n", fenced(whole)]
    for name in names:
        text = output(program, name, "--help").replace(ending, "")
        pages += [f"## {name}\n", fenced(text.split("\nExamples:")[0] if whole.split("\nExamples:")[1].split(ending)[0] in text else text)]
    return "\n".join(pages)


def configuration(program):
    return ("# Configuration\n\nEvery option with its meaning, unit and range, and its default: `salbench config` prints it. Options of\n"
            "models are those of [the table of models](models.md).\n\n" + fenced(output(program, "config"), "yaml"))


def metrics():
    rows = [(f"`{row.name}`", row.help, row.unit if row.unit != "1" else "", "higher" if row.higher_is_better else "lower")
            for row in salbench.metrics.table()]
    return ("# Table of metrics\n\nNames in `metrics:` of a configuration, columns of the tables, and functions of "
            "`salbench.metrics`.\n[Metrics](../metrics.md) has formulas and sources.\n\n" +
            table(("name", "value", "unit", "better"), rows))


def models():
    parts = ["# Table of models\n\nNames and options under `models:` of a configuration; functions of `salbench.models` in lower case.\n"
             "[Methods](../methods.md) says what they compute.\n"]
    for row in salbench.models.table():
        about = getattr(salbench.models, row.name.lower()).__doc__.split("\n")[0]
        parts.append(f"## {row.name}\n\n{about} Reads {', '.join(row.reads)}{', and random numbers' if row.random else ''}.\n")
        if row.options:
            parts.append(table(("option", "default", "meaning"), [(f"`{name}`", value, note) for name, value, note in row.options]))
    return "\n".join(parts)


def python():
    """Autodoc's directives, since docstrings are reStructuredText."""
    def directive(name, options=":members:\n   :no-special-members:"):
        return f".. automodule:: {name}\n   {options}\n"
    names = [name for name in salbench.__all__ if name not in ("__version__", "metrics", "models", "stats")]
    members = "\n".join(f".. auto{'class' if isinstance(getattr(salbench, name), type) else 'function'}:: salbench.{name}"
                        + ("\n   :members:" if isinstance(getattr(salbench, name), type) else "") for name in names)
    return ("# Python package\n\n[salbench in Python](../python.md) introduces it.\n\n## salbench\n\n" + fenced(members, "{eval-rst}") +
            "\n## salbench.stats\n\n" + fenced(directive("salbench.stats"), "{eval-rst}"))


def bibliography():
    entries = []
    for line in (DOCS / "bibliography.bib").read_text(encoding="utf-8").splitlines():
        key = re.match(r"@\w+\{([^,]+),", line)
        if not key:
            continue
        fields = {name: re.sub(r"\\[\"'^`~]|[{}]", "", value) for name, value in re.findall(r"(\w+)=\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}", line)}
        venue = next((fields[name] for name in ("journal", "booktitle", "institution", "publisher") if name in fields), "")
        entries.append(f"`{key[1]}`\n: " + ". ".join(filter(None, (fields.get("author"), f"*{fields['title']}*", venue, fields.get("year")))))
    return "# Bibliography\n\nKeys in brackets, on these pages and in the program's sources, are these.\n\n" + \
        "\n\n".join(sorted(entry.replace("\n: ", ": ") for entry in entries)) + "\n"


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True)
    pages = {"commands": commands(program), "configuration": configuration(program), "metrics": metrics(), "models": models(),
             "python": python(), "bibliography": bibliography()}
    for name, text in pages.items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
