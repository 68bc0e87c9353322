# SPDX-License-Identifier: GPL-3.0-or-later
"""The subcommands of this side: `salbench NAME`, which the program hands over, is `python3 -P -m salbench NAME`."""

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

ALL_DONE, UNUSABLE_ARGUMENTS, UNUSABLE_STORAGE, DEFECT, INTERRUPTED = 0, 2, 3, 70, 130
SCHEMA = 1  # of documents of JSON: raised when a key goes, or changes its type or its meaning


_EXAMPLES = {"conclude": "results.csv --unit class --out tables", "power": "salbench-out/shrec07", "report": "salbench-out/shrec07"}  # as `salbench --help` has them


class _Parser(argparse.ArgumentParser):
    def format_help(self) -> str:
        """In the form of the program's own subcommands."""
        formatter = self._get_formatter()
        formatter.add_text(self.description)
        formatter.add_usage(self.usage, self._actions, self._mutually_exclusive_groups, "Usage: ")
        for title, group in zip(("Positionals", "Options"), self._action_groups):
            formatter.start_section(title)
            formatter.add_arguments(group._group_actions)
            formatter.end_section()
        formatter.add_text(self.epilog)
        return formatter.format_help()

    def error(self, message: str) -> NoReturn:
        self.exit(UNUSABLE_ARGUMENTS, f"error: {message}; {self.prog} --help names what there is\n")


def _parser(name: str, summary: str, scores: str) -> argparse.ArgumentParser:
    return _Parser(prog=f"salbench {name}", usage=f"salbench {name} [OPTIONS] {scores}", allow_abbrev=False,
                   description=summary[:1].lower() + summary[1:].rstrip("."), epilog=f"Examples:\n  salbench {name} {_EXAMPLES[name]}",
                   formatter_class=argparse.RawDescriptionHelpFormatter)


def _add_output(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument("--format", default="text", help="text (default), or json: one document for programs (docs/json.md)")
    parser.add_argument("--quiet", action="store_true", help=f"no {what}; warnings and errors only")


def _scores_parser(name: str, summary: str, scores: str, **of_scores: Any) -> argparse.ArgumentParser:
    parser = _parser(name, summary, scores)
    parser.add_argument("scores", metavar=scores, help="results folder of a run, or a CSV file with columns item, model, metrics, and view of scans",
                        **of_scores)
    parser.add_argument("--classes", metavar="FILE", help="CSV file with columns item and class; of a table of scores alone")
    parser.add_argument("--unit", help="what counts as one observation: mesh, class or shape (default: as the run has it, or mesh)")
    parser.add_argument("--higher", default="", metavar="NAMES", help="further columns of scores of which higher ones are better")
    parser.add_argument("--lower", default="", metavar="NAMES", help="further columns of scores of which lower ones are better")
    _add_output(parser, "table")
    return parser


def conclude(arguments: Sequence[str]) -> int:
    """Means, intervals, tests and ranks of scores per shape, of a run or of anybody's."""
    from dataclasses import replace

    from salbench import conclusions
    from salbench.conclusions.statements import read_statements

    parser = _scores_parser("conclude", conclude.__doc__ or "", "OUT|SCORES.csv")
    parser.add_argument("--statements", metavar="FILE", help="CSV file of what a text says of pairs of models, like configs/paper/claims.csv: "
                        "each beside what the scores say, in statements.csv")
    parser.add_argument("--out", metavar="DIR", help="folder of the tables (default: OUT, or salbench-out/NAME)")
    parser.add_argument("--of", metavar="DIGEST", help="of what the scores were made of, which conclusions.json repeats")
    given = parser.parse_args(arguments)
    claims = read_statements(given.statements) if given.statements else None
    source = _source(given)
    concluded = conclusions.conclude(replace(source, study=replace(source.study, claims=claims)), given.out, given.of)
    text = f"{concluded.text}one observation per {concluded.unit}; tables in {concluded.folder}\n"
    document = {"results": str(concluded.folder), "unit": concluded.unit, "scores": concluded.scores, "leaders": concluded.leaders}
    return _print(given, "conclude", document, text)


def power(arguments: Sequence[str]) -> int:
    """Which differences between models the scores can show, and how many units would show those seen."""
    from salbench.conclusions import folders, tables
    from salbench.conclusions.power import power as power_of

    parser = _scores_parser("power", power.__doc__ or "", "OUT", nargs="?")
    parser.add_argument("--to", metavar="FILE", help="CSV file to write the table to")
    given = parser.parse_args(arguments)
    given.scores = given.scores or _only_results()
    source = _source(given)
    table = power_of(source.study)
    if given.to:
        folders.write(Path(given.to), tables.csv(table))
    unit = source.study.unit
    text = (f"{tables.aligned(table)}\none observation per {unit}; detectable: the difference of means that n of them show with probability 0.8 at "
            "0.05;\nn_to_detect: how many would show a true difference as large as the one seen\n")
    return _print(given, "power", {"unit": unit, "pairs": tables.records(table)}, text)


def report(arguments: Sequence[str]) -> int:
    """Pages of a run that open from disk: who leads and how sure, figures, maps on the shapes."""
    parser = _parser("report", report.__doc__ or "", "OUT")
    parser.add_argument("results", metavar="OUT", help="results folder of salbench run or evaluate")
    parser.add_argument("--to", metavar="DIR", help="folder of the report (default: OUT/report)")
    parser.add_argument("--export", metavar="FILE.h5", nargs="+", action="extend", default=[],
                        help="exports of shapes to show, with the pictures of salbench pictures (default: OUT/shapes.h5 if it exists)")
    parser.add_argument("--compare", metavar="OUT2", help="results folder of another run, laid beside this one")
    parser.add_argument("--examples", metavar="ITEMS", default="", help="meshes to show as examples, such as 52,125 (default: chosen by score)")
    parser.add_argument("--processes", metavar="N", type=int, default=len(os.sched_getaffinity(0)),
                        help="that draw at the same time; the report does not depend on it (default: one per core)")
    _add_output(parser, "path")
    if arguments[:1] == ["leaderboard"]:  # of salbench leaderboard
        from salbench.report.leaderboard import main

        return main(arguments[1:])
    given = parser.parse_args(arguments)
    _check_format(given)
    with tempfile.TemporaryDirectory() as scratch:  # Matplotlib's font list: nothing is written outside the folder of the report
        os.environ["MPLCONFIGDIR"] = scratch
        from salbench.report.write import write_report

        page = write_report(Path(given.results), to=Path(given.to) if given.to else None, exports=given.export,
                            compare=Path(given.compare) if given.compare else None, examples=_names(given.examples),
                            processes=given.processes)
    return _print(given, "report", {"page": str(page)}, f"{page}\n")


SUBCOMMANDS = {"conclude": conclude, "power": power, "report": report}


def _check_format(given: argparse.Namespace) -> None:
    from salbench.conclusions.csv_file import InputError

    if given.format not in ("text", "json"):
        raise InputError(f"--format {given.format}: must be text or json")


def _source(given: argparse.Namespace) -> Any:
    """The scores, with a warning of columns that are left out."""
    from salbench import conclusions

    _check_format(given)
    source = conclusions.source_of(given.scores, given.unit, classes=given.classes, higher=_names(given.higher), lower=_names(given.lower))
    for note in source.notes:
        print(f"warning: {note}", file=sys.stderr)
    return source


def _names(text: str) -> list[str]:
    return [name for name in text.split(",") if name]


def _only_results() -> str:
    """The only results below salbench-out."""
    from salbench.conclusions.csv_file import InputError

    found = sorted(str(path.parent) for path in Path("salbench-out").glob("*/results.csv"))
    if len(found) == 1:
        return found[0]
    raise InputError(f"name one of the results: {', '.join(found)}" if found else "salbench-out has no results: name their folder")


def _print(given: argparse.Namespace, name: str, document: dict[str, Any], text: str) -> int:
    if given.format == "json":
        text = json.dumps({"schema": SCHEMA, "command": name, **document}, ensure_ascii=False, separators=(",", ":")) + "\n"
    elif given.quiet:
        return ALL_DONE
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        return _fail(UNUSABLE_STORAGE, f"standard output: cannot be written: {error.strerror}")
    return ALL_DONE


def main(arguments: Sequence[str] | None = None) -> int:
    """Carries out a subcommand; returns its exit status."""
    name, *others = sys.argv[1:] if arguments is None else arguments or [""]
    if name not in SUBCOMMANDS:
        return _fail(UNUSABLE_ARGUMENTS, f"there is no subcommand '{name}' in the package; there are {', '.join(SUBCOMMANDS)}")
    from salbench.conclusions.csv_file import InputError
    from salbench.conclusions.folders import StorageError

    try:
        return SUBCOMMANDS[name](others)
    except InputError as error:
        return _fail(UNUSABLE_ARGUMENTS, str(error))
    except StorageError as error:
        return _fail(UNUSABLE_STORAGE, str(error))
    except OSError as error:
        return _fail(UNUSABLE_ARGUMENTS, f"{error.filename}: cannot be read: {error.strerror}")
    except KeyboardInterrupt:
        return INTERRUPTED
    except ModuleNotFoundError:
        raise  # the program says what to install
    except MemoryError:
        return _fail(DEFECT, "out of memory; use fewer metrics or models")
    except Exception as error:  # the last line of defence: a status that callers know, and what to report
        return _fail(DEFECT, f"a defect of salbench, please report it: {type(error).__name__}: {error}")


def _fail(status: int, message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
