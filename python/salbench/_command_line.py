# SPDX-License-Identifier: GPL-3.0-or-later
"""What the subcommands of the package have in common with those of the program: help, reports, exit statuses."""

import argparse
import contextlib
import errno
import json
import os
import signal
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from salbench._errors import InputError, StorageError

ALL_DONE, SOME_FAILED, UNUSABLE_ARGUMENTS, UNUSABLE_STORAGE, DEFECT = 0, 1, 2, 3, 70
SCHEMA = 2  # of documents of JSON: raised when a key goes, or changes its type or its meaning
_DECIMALS = 4  # of numbers on the console

_PATHS = ("CONFIG", "DIR", "FILE", "FILE.h5", "FOLDER", "MINE", "OUT", "OUT2", "OUT|SCORES.csv")  # an empty one would be the present folder

_EXAMPLES = {  # as `salbench --help` has them
    "conclude": "results.csv --unit class --out tables",
    "import": "3dva --data 3DVA --to 3DVA-hdf5",
    "inspect": "3dva --data 3DVA",
    "report": "salbench-out/shrec07",
    "submit": "mine --to mine.zip --data SchellingData",
    "leaderboard": "submissions --to site --data SchellingData",
    "reproduce": "mine.zip --model mine --data SchellingData",
}


class Parser(argparse.ArgumentParser):
    """A subcommand, with its help in the form of the program's own."""

    def __init__(self, name: str, summary: str, usage: str) -> None:
        super().__init__(prog=f"salbench {name}", usage=f"salbench {name} [OPTIONS] {usage}", allow_abbrev=False,
                         description=summary[:1].lower() + summary[1:].rstrip("."), epilog=f"Examples:\n  salbench {name} {_EXAMPLES[name]}",
                         formatter_class=argparse.RawDescriptionHelpFormatter)

    def add_report(self, quiet: str = "") -> None:
        self.add_argument("--format", default="text", help="text (default), or json: one document for programs (docs/json.md)")
        if quiet:
            self.add_argument("--quiet", action="store_true", help=quiet)

    def add_count(self, name: str, text: str, default: int | None = None) -> None:
        """An option for a number of threads or processes."""
        self.add_argument(name, metavar="N", type=_count, default=default, help=text)

    def format_help(self) -> str:
        formatter = self._get_formatter()
        formatter.add_text(self.description)
        formatter.add_usage(self.usage, self._actions, self._mutually_exclusive_groups, "Usage: ")
        for title, group in zip(("Positionals", "Options"), self._action_groups):
            formatter.start_section(title)
            formatter.add_arguments(group._group_actions)
            formatter.end_section()
        formatter.add_text(self.epilog)
        return formatter.format_help()

    def print_help(self, file: Any = None) -> None:
        _write_output(self.format_help())

    def parsed(self, arguments: Any) -> argparse.Namespace:
        given = self.parse_args(arguments)
        if given.format not in ("text", "json"):
            raise InputError(f"--format {given.format}: must be text or json")
        for action in self._actions:
            values = getattr(given, action.dest, None)
            if action.metavar in _PATHS and "" in (values if isinstance(values, list) else [values]):
                name = action.option_strings[-1] if action.option_strings else action.metavar
                raise InputError(f"{name}: is empty: name a file or a folder")
        return given

    def error(self, message: str) -> NoReturn:
        self.exit(UNUSABLE_ARGUMENTS, f"error: {message}; {self.prog} --help names what there is\n")


def _count(text: str) -> int:
    from salbench import _core

    try:
        return _core.thread_count(int(text), "N")
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number from 1 to {_core.most_threads}, not '{text}'") from None


def report(given: argparse.Namespace, name: str, document: dict[str, Any], text: str) -> None:
    """Prints the document, or else the text."""
    if given.format == "json":
        text = json.dumps({"schema": SCHEMA, "command": name, **document}, ensure_ascii=False, separators=(",", ":")) + "\n"
        text = text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")  # of names that are no UTF-8
    elif getattr(given, "quiet", False):
        return
    _write_output(text)


def _write_output(text: str) -> None:
    """To standard output. Where that fails the command ends: with an error or, where nobody reads, by SIGPIPE."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        if isinstance(error, BrokenPipeError) and "broken_pipe_is_an_error" not in sys._xoptions:  # an end without a word, as of the program
            signal.signal(signal.SIGPIPE, signal.SIG_DFL)
            os.kill(os.getpid(), signal.SIGPIPE)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for what is left of the text: Python ends with status 120 where it cannot write that
        closed = error.errno == errno.EBADF
        raise StorageError(f"standard output: {'it is closed' if closed else f'cannot be written: {error.strerror}'}") from None


def aligned(names: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """For the console: columns two spaces apart, numbers to the right, "-" for what is not known."""
    columns = []
    for number, name in enumerate(names):
        values = [row[number] for row in rows]
        cells = [name, *map(_cell, values)]
        width = max(map(len, cells))
        of_text = any(isinstance(value, str) for value in values)
        columns.append([cell.ljust(width) if of_text else cell.rjust(width) for cell in cells])
    return "".join("  ".join(line).rstrip(" ") + "\n" for line in zip(*columns))


def _cell(value: Any) -> str:
    if not isinstance(value, float):
        return str(value)
    if value != value:
        return "-"
    vanishes = value != 0 and abs(value) < 0.5 * 10.0**-_DECIMALS  # a value that rounds to 0 keeps its magnitude
    return f"{value:.1e}" if vanishes else f"{value:.{_DECIMALS}f}"


class Forgiving:
    """Standard error that may take no text, as on a full disk: messages that nobody gets cost no result."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with contextlib.suppress(OSError):
            self._stream.write(text)
            self._stream.flush()
        return len(text)

    def flush(self) -> None:
        with contextlib.suppress(OSError):
            self._stream.flush()


def warn(kind: str, line: str) -> None:
    """ "warning: ..." on standard error."""
    print(f"{kind}: {line}", file=sys.stderr, flush=True)
