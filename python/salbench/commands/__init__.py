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
        "compute what is missing and write the tables",
        "CONFIG",
        (
            ("configs/shrec07.yaml --data SchellingData", "the whole benchmark; run it again to resume"),
            (
                "configs/shrec07.yaml --data SchellingData --items 1-20,52",
                "these, matched to the mean over all",
            ),
            ("configs/shrec07.yaml --data SchellingData --items scored", "all shapes that have ground truth"),
            ("configs/shrec07.yaml --data SchellingData --shard 2/4", "the second of four shares"),
            (
                "configs/shrec07_meshes.yaml --data SchellingData --maps mine --name MINE",
                "and your maps: mine/52.val",
            ),
            (
                "configs/shrec07_meshes.yaml --data SchellingData --maps mine.h5 --name MINE --models RS",
                "beside chance alone",
            ),
        ),
    ),
    # For work in Python or a viewer, or an archive of a study, after the run.
    "export": Subcommand(
        "write what is known of some items to one HDF5 file, to shapes for viewers, or the maps alone",
        "CONFIG",
        (
            (
                "configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5",
                "all that is known of one shape",
            ),
            (
                "configs/shrec07.yaml --data SchellingData --items 52 --to 52.h5 --pictures",
                "with pictures, for a report that shows shapes",
            ),
            (
                "salbench-out/shrec07/run.yaml --items 52 --to 52.h5 --pictures",
                "of a run that was made, with models that are functions of Python or maps from outside",
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
        "count what is in the cache, and what a run would compute and why; changes nothing",
        "CONFIG [ITEM] [STAGE]",
        (
            ("configs/shrec07.yaml --data SchellingData", "what a run would compute, and why"),
            ("configs/shrec07.yaml 52_3 --data SchellingData", "each stage of one scan"),
            (
                "configs/shrec07.yaml 52 map.LS --data SchellingData",
                "how the recipe of a map differs from those in the cache",
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
            ("shrec07", "a configuration with all that it leaves out"),
        ),
        ends_at_once=True,
    ),
    # For owners of a cache, after disk trouble, and before publication of results.
    "verify": Subcommand(
        "read every artefact of a cache and name each bad one",
        "[CONFIG...]",
        (
            ("configs/shrec07.yaml --data SchellingData --deep", "read all, and compute 20 jobs again"),
            ("--cache salbench-cache", "read every artefact of a cache"),
        ),
    ),
    # For owners of a cache, when the disk fills up.
    "gc": Subcommand(
        "remove from a cache what no run of these configurations needs",
        "[CONFIG...]",
        (
            ("configs/shrec07.yaml --data SchellingData --dry-run", "what no run of it needs"),
            ("--cache salbench-cache --stage map.LS", "all maps of a model"),
        ),
        ends_at_once=True,
    ),
    # For statistics of scores, from a run or other sources.
    "conclude": Subcommand(
        "means, intervals, tests and ranks of scores per shape, of a run or of anybody's",
        "OUT|SCORES.csv",
        (("results.csv --unit class --out tables", "with classes as observations"),),
    ),
    # For users and authors of data sets.
    "import": Subcommand(
        "write a data set as HDF5, a file per shape and an index, which is the layout hdf5",
        "LAYOUT",
        (("3dva --data 3DVA --to 3DVA-hdf5", "the same set, an HDF5 file per shape"),),
    ),
    "inspect": Subcommand(
        "read all files of a data set and print what is in them: items, splits, ranges, problems",
        "LAYOUT",
        (("3dva --data 3DVA", "a row per item, and what is wrong"),),
    ),
    # For authors of a model; for maintainers and readers of a leaderboard.
    "submit": Subcommand(
        "check maps of your own and write the file that a leaderboard takes",
        "MINE",
        (("mine --to mine.zip --data SchellingData", "checked, and ready to be handed in"),),
    ),
    "leaderboard": Subcommand(
        "check and score submissions, and make a site that ranks them",
        "FOLDER",
        (("submissions --to site --data SchellingData", "site/index.html ranks those that pass"),),
    ),
    "reproduce": Subcommand(
        "make the maps of a submission again, by the command of its card, and say how near they come",
        "CARD",
        (("mine.zip --model mine --data SchellingData", "code and weights are in the folder mine"),),
    ),
    # For viewing a run.
    "report": Subcommand(
        "pages of a run that open from disk: who leads and how sure, figures, maps on the shapes",
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
  -h, --help   print this help, or with a subcommand that of it
  --version    print the version, and those of libraries

Subcommands:
{subcommands}
{examples}
Exit status: 0 all done; 1 some items failed, each was named; 2 unusable arguments or configuration;
3 cache, output folder or standard output unusable; 70 a defect of the program, or memory ran out;
130 interrupted, the line that resumes was printed.
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
