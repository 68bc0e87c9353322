# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `salbench`: dispatches the words of a command line to a subcommand.

A subcommand is a row here and a module of its name, imported on call: add_arguments(parser), and
carry_out(given), which returns the exit status. Help imports only a parser.
"""

from typing import NamedTuple


class Subcommand(NamedTuple):
    summary: str
    takes: str  # beside options
    # words after its name, and a remark; the help of the program shows the first
    examples: tuple[tuple[str, str], ...]
    ends_at_once: bool = False  # a signal ends it at once; otherwise it finishes work in progress


SUBCOMMANDS = {
    # For everybody: the benchmark of a configuration, also after changes or interruptions. For authors of a
    # model with existing maps: its scores beside the others.
    "run": Subcommand(
        "compute missing results and write the tables",
        "CONFIG",
        (
            ("configs/shrec07.yaml --data SchellingData", "the whole benchmark; run it again to resume"),
            (
                "configs/shrec07.yaml --data SchellingData --items 1-20,52",
                "these shapes, matched to the mean over all",
            ),
            ("configs/shrec07.yaml --data SchellingData --items scored", "all shapes with ground truth"),
            ("configs/shrec07.yaml --data SchellingData --shard 2/4", "the second of four shares"),
            (
                "configs/shrec07_meshes.yaml --data SchellingData --maps mine --name MINE",
                "with your maps: mine/52.val",
            ),
            (
                "configs/shrec07_meshes.yaml --data SchellingData --maps mine.h5 --name MINE --models RS",
                "compared only with chance",
            ),
        ),
    ),
    # For work in Python or a viewer, or an archive of a study, after the run.
    "export": Subcommand(
        "write data on items to one HDF5 file, to shape files for viewers, or only the maps",
        "CONFIG",
        (
            ("configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5", "everything on one shape"),
            (
                "configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5 --pictures",
                "with pictures, for a report that shows shapes",
            ),
            (
                "salbench-out/shrec07/run.yaml --items 52 --to 52.h5 --pictures",
                "of an existing run, with Python functions as models or external maps",
            ),
            ("configs/shrec07.yaml --data SchellingData --items 52 --to shapes --format ply", "for a viewer"),
            (
                "configs/shrec07.yaml --data SchellingData --items 52 --models LS,PS --to maps --format maps",
                "maps/LS/52.val and others",
            ),
        ),
    ),
    # Before a long run, to see the jobs and the reasons; during one, from another terminal. With an item, to
    # investigate unexpected jobs. For changes to the table of rules: its graph.
    "plan": Subcommand(
        "count cached results, and the jobs of a run with reasons; changes nothing",
        "CONFIG [ITEM] [STAGE]",
        (
            ("configs/shrec07.yaml --data SchellingData", "jobs of a run, with reasons"),
            ("configs/shrec07.yaml 52_3 --data SchellingData", "each stage of one scan"),
            (
                "configs/shrec07.yaml 52 map.LS --data SchellingData",
                "differences of a map's recipe from those in the cache",
            ),
            (
                "configs/shrec07.yaml --graph --format dot | dot -Tsvg",
                "the flow graph of a run, as a picture",
            ),
        ),
        ends_at_once=True,
    ),
    # For authors of configurations: the available options.
    "config": Subcommand(
        "print the complete configuration: every option with its help, unit and range",
        "[CONFIG]",
        (
            ("", "every option, its default, unit and range"),
            ("shrec07", "a configuration with all defaults filled in"),
        ),
        ends_at_once=True,
    ),
    # For owners of a cache, after disk trouble, and before publication of results.
    "verify": Subcommand(
        "read every artefact of a cache and report damaged ones",
        "[CONFIG...]",
        (
            ("configs/shrec07.yaml --data SchellingData --deep", "read all, and recompute 20 jobs"),
            ("--cache salbench-cache", "read every artefact of a cache"),
        ),
    ),
    # For owners of a cache, when the disk fills up.
    "gc": Subcommand(
        "remove artefacts from a cache that no run of these configurations needs",
        "[CONFIG...]",
        (
            (
                "configs/shrec07.yaml --data SchellingData --dry-run",
                "lists artefacts that no run of it needs",
            ),
            ("--cache salbench-cache --stage map.LS", "all maps of a model"),
        ),
        ends_at_once=True,
    ),
    # For statistics of scores, from a run or other sources.
    "conclude": Subcommand(
        "means, intervals, tests and ranks from scores per shape, of a run or a table",
        "OUT|SCORES.csv",
        (("results.csv --unit class --out tables", "with classes as observations"),),
    ),
    # For users and authors of data sets.
    "import": Subcommand(
        "convert a data set to the layout hdf5: one HDF5 file per shape, and an index",
        "LAYOUT",
        (("3dva --data 3DVA --to 3DVA-hdf5", "the same set, one HDF5 file per shape"),),
    ),
    "inspect": Subcommand(
        "read all files of a data set and print items, splits, ranges, problems",
        "LAYOUT",
        (("3dva --data 3DVA", "a row per item, and all problems"),),
    ),
    # For authors of a model; for maintainers and readers of a leaderboard.
    "submit": Subcommand(
        "check your maps and write a submission to a leaderboard",
        "MINE",
        (("mine --to mine.zip --data SchellingData", "checked, and ready to submit"),),
    ),
    "leaderboard": Subcommand(
        "check and score submissions, and write a site that ranks them",
        "FOLDER",
        (("submissions --to site --data SchellingData", "site/index.html ranks those that pass"),),
    ),
    "reproduce": Subcommand(
        "recompute the maps of a submission by its command, and compare",
        "CARD",
        (("mine.zip --model mine --data SchellingData", "code and weights are in the folder mine"),),
    ),
    # For viewing a run.
    "report": Subcommand(
        "write offline pages of a run: leaders with uncertainty, figures, maps on shapes",
        "OUT",
        (("salbench-out/shrec07", "salbench-out/shrec07/report/index.html"),),
    ),
}

FORMER = {  # names of version 0.2, and their replacements
    "convert": "import LAYOUT --data DIR --to DIR2",
    "doctor": "plan CONFIG --data DIR",
    "evaluate": "run CONFIG --data DIR --maps MAPS --name NAME",
    "graph": "plan CONFIG --graph",
    "maps": "export CONFIG --data DIR --format maps --to MAPS",
    "pictures": "export CONFIG --data DIR --pictures --to FILE.h5",
    "power": "conclude OUT, which writes power.csv",
    "status": "plan CONFIG --data DIR",
}

_LINE = 66  # characters of an example before its remark; longer ones have it below

_HELP = """\
Benchmark of 3D saliency models on meshes, simulated range scans and point clouds.
Usage: salbench [OPTIONS] SUBCOMMAND

Options:
  -h, --help   print this help, or that of a subcommand
  --version    print the versions of salbench and its libraries

Subcommands:
{subcommands}
{examples}
Exit status: 0 success; 1 some items failed, each was reported; 2 invalid arguments or configuration;
3 cache, output folder or standard output unusable; 70 internal error, or out of memory;
130 interrupted, the command to resume was printed.
"""


def help_text() -> str:
    subcommands = "".join(f"  {name:<11}  {known.summary}\n" for name, known in SUBCOMMANDS.items())
    examples = "".join(_example(name, *known.examples[0]) for name, known in SUBCOMMANDS.items())
    return _HELP.format(subcommands=subcommands, examples=f"Examples:\n{examples}")


def examples_text(name: str, examples: tuple[tuple[str, str], ...]) -> str:
    return "Examples:\n" + "".join(_example(name, *example) for example in examples)


def _example(name: str, words: str, remark: str) -> str:
    line = f"{name} {words}".rstrip()
    return (
        f"  salbench {line}\n{'':{_LINE + 13}}{remark}\n"
        if len(line) > _LINE
        else f"  salbench {line:<{_LINE}}  {remark}\n"
    )
