# SPDX-License-Identifier: GPL-3.0-or-later
"""The subcommands of this side: `salbench NAME`, which the program hands over, is `python3 -P -m salbench NAME`."""

import errno
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from typing import Any

UNUSABLE_ARGUMENTS, UNUSABLE_STORAGE, DEFECT = 2, 3, 70


def conclude(arguments: Sequence[str]) -> int:
    """Means, intervals, tests and ranks of scores per shape, of a run or of anybody's."""
    from salbench import conclusions
    from salbench._command_line import ALL_DONE, Parser, report

    parser = Parser("conclude", conclude.__doc__ or "", "OUT|SCORES.csv")
    parser.add_argument("scores", metavar="OUT|SCORES.csv",
                        help="results folder of a run, or a CSV file with columns item, model, metrics, and view of scans")
    parser.add_argument("--classes", metavar="FILE", help="CSV file with columns item and class; of a table of scores alone")
    parser.add_argument("--unit", help="what counts as one observation: mesh, class or shape (default: as the run has it, or mesh)")
    parser.add_argument("--higher", default="", metavar="NAMES", help="further columns of scores of which higher ones are better")
    parser.add_argument("--lower", default="", metavar="NAMES", help="further columns of scores of which lower ones are better")
    parser.add_report("no table; warnings and errors only")
    parser.add_argument("--out", metavar="DIR", help="folder of the tables (default: OUT, or salbench-out/NAME)")
    parser.add_argument("--of", metavar="DIGEST", help="of what the scores were made of, which conclusions.json repeats")
    given = parser.parsed(arguments)
    source = conclusions.source_of(given.scores, given.unit, classes=given.classes, higher=_names(given.higher), lower=_names(given.lower))
    for note in source.notes:
        print(f"warning: {note}", file=sys.stderr)
    concluded = conclusions.conclude(source, given.out, given.of)
    text = f"{concluded.text}one observation per {concluded.unit}; tables in {concluded.folder}\n"
    document = {"results": str(concluded.folder), "unit": concluded.unit, "scores": concluded.scores, "leaders": concluded.leaders}
    report(given, "conclude", document, text)
    return ALL_DONE


def import_(arguments: Sequence[str]) -> int:
    """Write a data set in one form, an HDF5 file per shape and an index, which is the layout hdf5."""
    from salbench.datasets.importing import command

    return command(arguments, import_.__doc__ or "")


def inspect(arguments: Sequence[str]) -> int:
    """Read all files of a data set and print what its description finds: items, splits, ranges, problems."""
    from salbench.datasets.inspecting import command

    return command(arguments, inspect.__doc__ or "")


def submit(arguments: Sequence[str]) -> int:
    """Check maps of your own and write the file that a leaderboard takes."""
    from salbench._command_line import Parser

    parser = Parser("submit", submit.__doc__ or "", "MINE")
    parser.add_argument("mine", metavar="MINE", help="folder with ITEM.val of every item with ground truth, and card.yaml")
    parser.add_argument("--to", metavar="FILE", required=True, help="the file to write, such as mine.zip")
    return _over_data("submit", parser, arguments)


def leaderboard(arguments: Sequence[str]) -> int:
    """Check and score submissions, and make a site that ranks them."""
    from salbench._command_line import Parser

    parser = Parser("leaderboard", leaderboard.__doc__ or "", "FOLDER")
    parser.add_argument("folder", metavar="FOLDER", help="folder of the submissions (NAME.zip)")
    parser.add_argument("--to", metavar="DIR", required=True, help="folder of the site")
    parser.add_argument("--models", metavar="NAMES", help="also these of the configuration, such as LS,PS (default: people and chance alone); "
                        "with them FOLDER may be empty")
    return _over_data("leaderboard", parser, arguments)


def reproduce(arguments: Sequence[str]) -> int:
    """Make the maps of a submission again, by the command of its card, and say how near they come."""
    from salbench._command_line import Parser

    parser = Parser("reproduce", reproduce.__doc__ or "", "CARD")
    parser.add_argument("card", metavar="CARD", help="the submission (NAME.zip), whose command is run as you: read it first (unzip -p NAME.zip model.yaml)")
    parser.add_argument("--model", metavar="DIR", default=".", help="folder with the code and weights that the command depends on; their digests must "
                        "be those of the card (default: the present folder)")
    parser.add_argument("--to", metavar="DIR", help="folder for tables by shape and metric, and with --by for the submission with a new card")
    parser.add_argument("--by", metavar="NAME", default="", help="who you are: a line of the new card says so, with what came out")
    return _over_data("reproduce", parser, arguments)


def _over_data(name: str, parser: Any, arguments: Sequence[str]) -> int:
    """A command that runs jobs."""
    from salbench.leaderboard import commands, reproduce, session

    session.add_arguments(parser, has_config=name != "reproduce")
    given = parser.parsed(arguments)
    return {"submit": commands.submit, "leaderboard": commands.leaderboard, "reproduce": reproduce.reproduce}[name](given)


def report_(arguments: Sequence[str]) -> int:
    """Pages of a run that open from disk: who leads and how sure, figures, maps on the shapes."""
    import os
    from pathlib import Path

    from salbench import _core
    from salbench._command_line import ALL_DONE, Parser, report

    parser = Parser("report", report_.__doc__ or "", "OUT")
    parser.add_argument("results", metavar="OUT", help="results folder of salbench run")
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: OUT/report)")
    parser.add_argument("--export", metavar="FILE.h5", nargs="+", action="extend", default=[],
                        help="exports of shapes to show, with the pictures that --pictures of salbench export takes (default: OUT/shapes.h5 if it exists, else what is in the cache of the run)")
    parser.add_argument("--examples", metavar="ITEMS", default="", help="meshes to show as examples, such as 52,125 (default: chosen by score)")
    parser.add_argument("--mine", metavar="MODEL", default="", help="the model that the report is about: first and marked in every table, and compared with each other one")
    parser.add_argument("--metrics", metavar="NAMES", default="", help="metrics that pages are about, such as nss,cc (default: the first of the run)")
    parser.add_argument("--models", metavar="NAMES", default="", help="models that pages show; ranks and groups stay those among all")
    parser.add_argument("--picks", action="store_true", help="what participants picked as dots on pictures of the ground truth; the viewer shows it in any case")
    parser.add_argument("--no-viewer", dest="viewer", action="store_false",
                        help="pictures alone: neither coordinates nor ground truth of the shapes, for pages that go where the data may not")
    parser.add_count("--processes", "that draw at the same time; the report does not depend on it (default: one per core)",
                     default=len(os.sched_getaffinity(0)))
    parser.add_report("no path; warnings and errors only")
    given = parser.parsed(arguments)
    with _core.ScratchFolder() as scratch:  # also for Matplotlib's font list: nothing is written outside the folder of the report
        os.environ |= {"MPLCONFIGDIR": scratch, "MPLBACKEND": "Agg"}
        from salbench.report.write import write_report

        page = write_report(Path(given.results), Path(scratch), to=Path(given.to) if given.to else None, exports=given.export,
                            examples=_names(given.examples),
                            processes=given.processes, viewer=given.viewer, picks=given.picks, mine=given.mine, metrics=_names(given.metrics),
                            models=_names(given.models))
    report(given, "report", {"page": str(page)}, f"{page}\n")
    return ALL_DONE


def _list(arguments: Sequence[str]) -> int:
    """`_list LAYOUT --data DIR`, which the program asks of layouts that it does not list itself."""
    from salbench import _wire
    from salbench.datasets.listing import document

    options = dict(zip(arguments[1::2], arguments[2::2]))
    sys.stdout.buffer.write(_wire.dumps(document(arguments[0], options["--data"])) + b"\n")
    return 0


def _layouts(arguments: Sequence[str]) -> int:
    """`_layouts DIR`: the end of a message on a folder that does not fit its layout."""
    from salbench.datasets.sets import layouts_that_fit

    sys.stdout.write(layouts_that_fit(arguments[0]))
    return 0


def _import(arguments: Sequence[str]) -> int:
    """Items of archives for the program, a request after the other."""
    from salbench.datasets.worker import main as serve

    return serve()


SUBCOMMANDS = {"conclude": conclude, "import": import_, "inspect": inspect, "submit": submit, "leaderboard": leaderboard, "reproduce": reproduce,
               "report": report_}
SERVED = {"_import": _import, "_layouts": _layouts, "_list": _list}  # for the program alone


def _names(text: str) -> list[str]:
    return [name for name in text.split(",") if name]


def main(arguments: Sequence[str] | None = None) -> int:
    """Carries out a subcommand; returns its exit status."""
    from salbench._command_line import Forgiving
    from salbench._processes import raise_interrupts, say_interrupted

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="surrogateescape")  # as the program writes; names of files may be no UTF-8
    if isinstance(sys.stderr, TextIOWrapper):  # and not forgiving yet
        setattr(sys, "stderr", Forgiving(sys.stderr))  # less than a TextIO, which versions of mypy mind or not
    name, *others = sys.argv[1:] or [""] if arguments is None else arguments or [""]
    try:
        if arguments is None and name in SUBCOMMANDS:
            raise_interrupts([name, *others])
        return _carry_out(name, others)
    except KeyboardInterrupt:
        return say_interrupted([name, *others])


def _carry_out(name: str, others: Sequence[str]) -> int:
    from salbench._errors import InputError, StorageError
    from salbench._files import LACKING

    subcommand = (SUBCOMMANDS | SERVED).get(name)
    if subcommand is None:
        return _fail(UNUSABLE_ARGUMENTS, f"there is no subcommand '{name}' in the package; there are {', '.join(SUBCOMMANDS)}")
    try:
        return subcommand(others)
    except InputError as error:
        return _fail(UNUSABLE_ARGUMENTS, str(error))
    except StorageError as error:
        return _fail(UNUSABLE_STORAGE, str(error))
    except OSError as error:
        if error.filename is None or error.errno in (*LACKING, errno.EIO):
            return _fail(UNUSABLE_STORAGE, ": ".join(filter(None, (error.filename and str(error.filename), error.strerror or str(error)))))
        return _fail(UNUSABLE_ARGUMENTS, f"{error.filename}: cannot be read: {error.strerror}")
    except ModuleNotFoundError:
        raise  # the program says what to install
    except MemoryError:
        return _fail(UNUSABLE_STORAGE, "out of memory; close other programs, or use fewer metrics or models")
    except Exception as error:  # the last line of defence: a status that callers know, and what to report
        return _fail(DEFECT, f"a defect of salbench, please report it: {type(error).__name__}: {error}")


def _fail(status: int, message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
