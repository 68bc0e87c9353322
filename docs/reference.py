#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the pages that are generated from the program; called by scripts/docs. reference.py PROGRAM
FOLDER"""

import csv
import itertools
import re
import subprocess
import sys
import tempfile
import unicodedata
from dataclasses import is_dataclass
from pathlib import Path

import salbench
from salbench._core import models_about

DOCS = Path(__file__).resolve().parent
# A run with every kind of array except those of faces.
EXPORTED = """
dataset: {layout: hdf5}
scan: {step_degrees: 2}
picture: {size: 16}
models: {LS: , HS: {draws: 5}}
metrics: {names: [auc, sauc], smoothing: [2]}
"""
ACCENTS = {'"': "\u0308", "'": "\u0301", "`": "\u0300", "v": "\u030c"}  # TeX accents, as combining characters


def output(*words):
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return done.stdout.replace(words[0], "salbench").rstrip() + "\n"


def fenced(text, language="text"):
    return f"```{language}\n{text.rstrip()}\n```\n"


def table(head, rows):
    def line(cells):
        return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"

    return "\n".join([line(head), "|" + "---|" * len(head), *map(line, rows)]) + "\n"


def sections(text):
    """Parts of a help text by heading, "" for the text above the first; a head is "Options:" on a line, or
    "Usage:" before its text."""
    parts = re.split(r"^([A-Z][\w ()-]*):(?: *\n| (?=\S))", text, flags=re.M)
    return {"": parts[0].strip()} | {head: part.rstrip() for head, part in zip(parts[1::2], parts[2::2])}


def rows(text):
    """Pairs [name, meaning] of lines that are indented by two blanks; deeper lines continue the meaning."""
    found = []
    for line in text.splitlines():
        if row := re.match(r"  (\S.*?)(?: {2,}(.*))?$", line):
            found.append([f"`{row[1]}`", row[2] or ""])
        elif found:
            found[-1][1] = f"{found[-1][1]} {line.strip()}".strip()
    return found


def command(program, name, ending):
    parts = sections(output(program, name, "--help"))
    text = [f"## {name}\n", parts[""] + ".\n", fenced(parts["Usage"])]
    text += [
        table(
            ("argument", "meaning"),
            rows("\n".join(parts.get(head, "") for head in ("Positionals", "Options"))),
        )
    ]
    if parts.get("Examples") and parts["Examples"] != ending:
        text.append(fenced(parts["Examples"]))
    return text


def commands(program):
    """The help of the program and of each subcommand, without the common ending."""
    whole = sections(output(program, "--help"))
    subcommands = [
        row for head, part in whole.items() if head.startswith("Subcommands") for row in rows(part)
    ]
    names = [name.strip("`") for name, _ in subcommands]
    links = [(f"[{name}](#{name})", meaning) for name, (_, meaning) in zip(names, subcommands)]
    pages = ["# Commands\n", fenced(whole["Usage"]), table(("subcommand", "what it does"), links)]
    pages += [fenced(whole["Examples"]), f"Exit status: {whole['Exit status']}\n"]
    return "\n".join(pages + [line for name in names for line in command(program, name, whole["Examples"])])


def configuration(program):
    return (
        "# Configuration\n\nEvery option with its meaning, unit and range, and its default: `salbench config`"
        " prints it. Options of\nmodels are those of [the table of models](models.md).\n\n"
        + fenced(output(program, "config"), "yaml")
    )


def metrics():
    rows = [
        (
            f"`{row.name}`",
            row.help,
            row.unit if row.unit != "1" else "",
            "higher" if row.higher_is_better else "lower",
        )
        for row in salbench.metrics.table()
    ]
    return (
        "# Table of metrics\n\nNames in `metrics:` of a configuration, columns of the tables, and functions"
        " of `salbench.metrics`.\n[Metrics](../metrics.md) has formulas and sources.\n\n"
        + table(("name", "value", "unit", "better"), rows)
    )


def models():
    parts = [
        "# Table of models\n\nNames and options under `models:` of a configuration; functions of"
        " `salbench.models` in lower case.\n[Methods](../methods.md) says what they compute. `floors` under"
        " `models:` stands for all trivial baselines.\n"
    ]
    for row in salbench.models.table():
        about = models_about[row.name]
        source = f" [{about.source}]({about.link})" if about.link else ""
        key = f" [{about.key}]" if about.key else ""
        parts.append(
            f"## {row.name}\n\n{about.summary}{f'{source}{key}.' if source or key else ''}{' Trivial baseline.' if about.is_floor else ''} Reads"
            f" {', '.join(row.reads)}{', and random numbers' if row.random else ''}.\n"
        )
        if row.options:
            parts.append(
                table(
                    ("option", "default", "meaning"),
                    [(f"`{name}`", value, note) for name, value, note in row.options],
                )
            )
    return "\n".join(parts)


def data_sets():
    """Terms of use, from the modules of data sets."""
    from salbench.datasets.sets import NATIVE, SETS, find

    terms = {name: find(name).licence for name in SETS} | {
        name: terms for name, terms in NATIVE.items() if terms
    }
    found = [(f"`{name}`", terms[name]) for name in sorted(terms)]
    return (
        "# Terms of data sets\n\nNo data is part of salbench; [Data sets](../data_sets.md) has the sources. Terms"
        " of the authors, as far as they are known:\n\n" + table(("layout", "terms"), found)
    )


def listed(name):
    """Rows of docs/tables/NAME.csv."""
    with open(DOCS / f"tables/{name}.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def arrays(program):
    """(kind, name) -> type, unit and description of each array, from an export."""
    import h5py

    found = {}

    def text(value):
        return value.decode() if isinstance(value, bytes) else str(value)

    def look(_, group):
        if "kind" in group.attrs:
            for name, array in group.items():
                found[text(group.attrs["kind"]), name] = [
                    str(array.dtype),
                    text(array.attrs["unit"]),
                    text(array.attrs["description"]),
                ]

    with tempfile.TemporaryDirectory() as folder:
        config, to = Path(folder, "config.yaml"), Path(folder, "all.h5")
        config.write_text(EXPORTED)
        data = DOCS.parent / "tests/stability/examples/set"
        subprocess.run(
            [
                program,
                "export",
                config,
                "--data",
                data,
                "--cache",
                Path(folder, "cache"),
                "--to",
                to,
                "--quiet",
            ],
            check=True,
        )
        with h5py.File(to) as file:
            file.visititems(look)
    return found


def conclusions():
    """A section per table of conclusions: the meaning of a row, and its own columns."""
    from salbench.conclusions import TABLES
    from salbench.conclusions.tables import SHARED

    def columns(several):
        return table(("column", "meaning"), [(f"`{column.name}`", column.meaning) for column in several])

    yield f"## Conclusions\n\nColumns of several tables:\n\n{columns(SHARED)}"
    for one in TABLES:
        what = re.sub(r" \[\w+\]", "", " ".join(one.make.__doc__.split()))
        own = [column for column in one.columns if column not in SHARED]
        yield f"### {one.name}.csv\n\n{what}\n" + (f"\n{columns(own)}" if own else "")


def tables(program):
    """Files and their columns, stages, and arrays."""
    parts = ["# Tables and arrays\n\n[Data dictionary](../data_dictionary.md) has common rules.\n"]
    for file, rows in itertools.groupby(listed("columns"), lambda row: row["file"]):
        parts.append(
            f"## {file}\n\n"
            + table(
                ("name", "unit", "meaning"),
                [(f"`{row['name']}`", row["unit"], row["meaning"]) for row in rows],
            )
        )
    parts += conclusions()
    stages = [
        (f"`{row['stage']}`", row["kind"], row["of"], row["place"], row["meaning"])
        for row in listed("stages")
    ]
    parts.append(
        "## Stages\n\n" + table(("stage", "kind of its arrays", "of", "in an export", "meaning"), stages)
    )
    found = [(kind, f"`{name}`", *about) for (kind, name), about in sorted(arrays(program).items())]
    parts.append("## Arrays\n\n" + table(("kind", "array", "type", "unit", "meaning"), found))
    return "\n".join(parts)


def documents():
    parts = [
        "# JSON documents\n\n[JSON for programs](../json.md) has common rules. `[]` stands for each element of"
        " a list.\n"
    ]
    for name, rows in itertools.groupby(listed("documents"), lambda row: row["document"]):
        rows = list(rows)
        further = [f"And {row['type']}.\n" for row in rows if not row["key"]]
        own = [(f"`{row['key']}`", row["type"], row["meaning"]) for row in rows if row["key"]]
        parts.append("\n".join([f"## {name}\n", table(("key", "type", "meaning"), own), *further]))
    return "\n".join(parts)


def python():
    """Autodoc's directives, since docstrings are reStructuredText."""

    def directive(name, module=salbench):
        what = getattr(module, name)
        # docstrings of named tuples describe their fields
        with_members = isinstance(what, type) and not issubclass(what, tuple) and not is_dataclass(what)
        return (
            f".. auto{'class' if isinstance(what, type) else 'function'}:: {module.__name__}.{name}"
            + "\n   :members:" * with_members
        )

    names = [name for name in salbench.__all__ if name not in ("__version__", "metrics", "models", "stats")]
    of_data = [directive(name, salbench.datasets) for name in salbench.datasets.__all__]
    return (
        "# Python package\n\n[Bring your model](../bring_your_model.md) introduces it.\n\n## salbench\n\n"
        + fenced("\n\n".join(map(directive, names)), "{eval-rst}")
        + "\n## salbench.datasets\n\n"
        + fenced("\n\n".join(of_data), "{eval-rst}")
        + "\n## salbench.stats\n\n"
        + fenced(".. automodule:: salbench.stats\n   :members:\n", "{eval-rst}")
    )


def entry(line):
    """A line of the bibliography as text: its key, and the fields, with braces up to two deep, without
    TeX."""
    fields = dict(re.findall(r"(\w+)=\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}", line))
    accented = re.compile(r"\\([\"'`v])\{?(\w)\}?")
    fields = {
        name: re.sub(
            "[{}]",
            "",
            accented.sub(lambda found: unicodedata.normalize("NFC", found[2] + ACCENTS[found[1]]), value),
        )
        for name, value in fields.items()
    }
    venue = next(
        (fields[name] for name in ("journal", "booktitle", "institution", "publisher") if name in fields), ""
    )
    parts = filter(
        None, (fields.get("author", "").rstrip("."), f"*{fields['title']}*", venue, fields.get("year"))
    )
    return f"`{re.match(r'@[a-z]+{([^,]+),', line)[1]}`: " + ". ".join(parts)


def bibliography():
    lines = (DOCS / "bibliography.bib").read_text(encoding="utf-8").splitlines()
    return (
        "# Bibliography\n\nKeys in brackets, on these pages and in the program's sources, are these.\n\n"
        + "\n\n".join(sorted(entry(line) for line in lines if line.startswith("@")))
        + "\n"
    )


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True)
    pages = {
        "commands": commands(program),
        "configuration": configuration(program),
        "metrics": metrics(),
        "models": models(),
        "tables": tables(program),
        "documents": documents(),
        "python": python(),
        "data_sets": data_sets(),
        "bibliography": bibliography(),
    }
    for name, text in pages.items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
