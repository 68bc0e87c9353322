# SPDX-License-Identifier: GPL-3.0-or-later
"""Parser of a subcommand's arguments, and its help."""

import argparse
import os
from collections.abc import Sequence
from typing import Any, NoReturn

from salbench.commands import Subcommand, examples_text
from salbench.system.console import UNUSABLE_ARGUMENTS, write_output
from salbench.system.errors import InputError

# An empty one would be the current folder.
_PATHS = ("CONFIG", "DIR", "DIR|FILE", "FILE", "FILE.h5", "FOLDER", "MINE", "OUT", "OUT|SCORES.csv", "TO")

_SCORED_BY = "shrec07_meshes"  # for submissions


class Parser(argparse.ArgumentParser):
    """Parser of a subcommand. Positional arguments may be anywhere among the options, and an option may be
    given once."""

    def __init__(self, name: str, known: Subcommand) -> None:
        super().__init__(
            prog=f"salbench {name}",
            usage=f"salbench {name} [OPTIONS] {known.takes}",
            allow_abbrev=False,
            description=known.summary,
            epilog=examples_text(name, known.examples),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        self.register("action", None, _Once)
        self._choices: dict[str, Sequence[str]] = {}
        self._rules: list[tuple[str, str, str]] = []
        self._words: Sequence[str] = ()

    # --- options that several subcommands have

    def _add_split(self) -> None:
        self.add_argument(
            "--split",
            metavar="NAME",
            help="only this split of the data set, such as test; '': all, if CONFIG names one",
        )

    def add_data_set(self) -> None:
        self.add_argument("--data", metavar="DIR", help="folder of the data set")
        self.add_argument(
            "--cache", metavar="DIR", help="folder of the cache (default: cache in CONFIG, or salbench-cache)"
        )
        self.add_argument(
            "--items",
            default="",
            metavar="LIST",
            help="only these shapes and their scans, such as 1-20,52,125; scored: all with ground truth",
        )
        self._add_split()
        self.add_argument(
            "--reference",
            metavar="FILE",
            help=(
                "match maps to this histogram (CSV with a column GS of 100 bins) instead of the mean "
                "over the data set; items: the mean over --items"
            ),
        )

    def add_planning(self) -> None:
        self.add_argument(
            "config",
            metavar="CONFIG",
            help=(
                "configuration file (YAML), run.yaml of a run (its configuration and items), or the "
                "name of an installed one, such as shrec07"
            ),
        )
        self.add_data_set()

    def add_running(self) -> None:
        self.add_planning()
        self.add_count("--threads", "threads (default: all cores); results do not depend on it")
        self.add_argument(
            "--keep-going",
            action="store_true",
            help="run a command or function on all shapes, even if it fails alike on its first five",
        )
        self.add_argument(
            "--quiet", action="store_true", help="no progress and no tables, only warnings and errors"
        )

    def add_output(self) -> None:
        self.add_argument(
            "--out",
            metavar="DIR",
            help="folder of the results (default: output in CONFIG, or salbench-out/NAME)",
        )
        self.add_argument(
            "--shard",
            default="",
            metavar="I/N",
            help="only share I of N of the items; a final run without this option merges the shares",
        )

    def add_given_maps(self, text: str) -> None:
        self.add_argument("--maps", metavar="DIR|FILE", help=text)
        self.add_argument("--name", metavar="NAME", help="name of these maps in the tables")
        self.add_argument("--matched", action="store_true", help="their values are already histogram-matched")
        for name, other in (("--maps", "--name"), ("--name", "--maps"), ("--matched", "--maps")):
            self.add_rule(name, "requires", other)

    def add_layout(self) -> None:
        self.add_argument(
            "layout",
            metavar="LAYOUT",
            help="layout of the data set: automatic, a name of docs/data_sets.md, or your own file (.py)",
        )
        self.add_argument("--data", metavar="DIR", help="folder of the data set")

    def add_scoring(self, of_submission: bool = False) -> None:
        """Adds options of a run over data with ground truth, with a default configuration; for a submission
        it is fixed."""
        if not of_submission:
            self.add_argument(
                "-c",
                "--config",
                metavar="CONFIG",
                default=_SCORED_BY,
                help=f"configuration, or the name of an installed one (default: {_SCORED_BY})",
            )
        self.add_argument("--data", metavar="DIR", help="folder of the data set")
        default = (
            "none: everything is computed; cached results count as computed here"
            if of_submission
            else "cache in CONFIG, or salbench-cache"
        )
        self.add_argument("--cache", metavar="DIR", help=f"folder of the cache (default: {default})")
        self._add_split()
        self.add_argument(
            "--reference",
            metavar="FILE",
            help=(
                "match maps to this histogram (CSV with a column GS of 100 bins) instead of the mean over "
                "the data set; items: the mean over the items with ground truth"
            ),
        )
        self.add_count("--threads", "threads (default: all cores); results do not depend on it")
        self.add_report("no progress and no tables, only warnings and errors")

    def add_report(self, quiet: str = "", forms: Sequence[str] = ("text", "json"), further: str = "") -> None:
        self.add_choice(
            "--format", forms, "text (default), or json: a document for programs (docs/json.md)" + further
        )
        if quiet:
            self.add_argument("--quiet", action="store_true", help=quiet)

    def add_choice(self, name: str, known: Sequence[str], text: str, dest: str | None = None) -> None:
        """Adds an option with a choice of words; the first is the default."""
        self._choices[name] = known
        self.add_argument(name, metavar="WORD", default=known[0], dest=dest or name.strip("-"), help=text)

    def add_count(self, name: str, text: str, default: int | None = None, most: int | None = None) -> None:
        """Adds an option for a number from 1, such as of threads or processes. most: default: the largest
        number of threads."""
        self.add_argument(
            name, metavar="N", type=lambda given: _count(given, most), default=default, help=text
        )

    def add_rule(self, name: str, verb: str, other: str) -> None:
        """Adds a rule between arguments. verb: "requires", "excludes"."""
        self._rules.append((name, verb, other))
        action = self._named(name)
        action.help = f"{action.help} ({verb} {other})"

    # --- parsing

    def parsed(self, words: Sequence[str]) -> argparse.Namespace:
        self._words = words
        given, left = self.parse_known_intermixed_args(words)
        if left:
            self.error(f"unexpected argument: {left[0]}")
        for action in self._actions:
            self._check(action, given)
        for name, verb, other in self._rules:
            if self._is_given(name, given) and self._is_given(other, given) != (verb == "requires"):
                self.error(f"{name} {verb} {other}")
        return given

    def _check(self, action: argparse.Action, given: argparse.Namespace) -> None:
        name, value = _name_of(action), getattr(given, action.dest, None)
        if action.metavar in _PATHS and "" in (value if isinstance(value, list) else [value]):
            raise InputError(f"{name}: is empty: name a file or a folder")
        known = self._choices.get(name)
        if known and value not in known:
            raise InputError(f"{name} {value}: must be {', '.join(known[:-1])} or {known[-1]}")

    def _is_given(self, name: str, given: argparse.Namespace) -> bool:
        action = self._named(name)
        return bool(getattr(given, action.dest) != action.default)

    def _named(self, name: str) -> argparse.Action:
        return next(action for action in self._actions if _name_of(action) == name)

    def error(self, message: str) -> NoReturn:
        """Reports an unknown option before other errors."""
        for word in (word.partition("=")[0] for word in self._words):
            if word.startswith("--") and word != "--" and word not in self._option_string_actions:
                from salbench import _core

                known = [
                    name for name in self._option_string_actions if name.startswith("--") and name != "--help"
                ]
                hint = _core.did_you_mean(os.fsencode(word), known, f"{self.prog} --help names them")
                self.exit(
                    UNUSABLE_ARGUMENTS,
                    f"error: {self.prog.split()[1]}: there is no option '{word}'; {hint}\n",
                )
        self.exit(UNUSABLE_ARGUMENTS, f"error: {message}; {self.prog} --help names what there is\n")

    # --- help

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
        write_output(self.format_help())


class _Once(argparse._StoreAction):
    """Refuses a second value for an option, which is a mistake."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        if option_string and getattr(namespace, self.dest, self.default) is not self.default:
            parser.error(f"{option_string} is given twice")
        setattr(namespace, self.dest, values)


def _name_of(action: argparse.Action) -> str:
    return action.option_strings[-1] if action.option_strings else str(action.metavar)


def _count(text: str, most: int | None) -> int:
    if most is None:
        from salbench import _core  # not needed by --help

        most = _core.most_threads
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:20]) <= most):
        raise argparse.ArgumentTypeError(f"must be a whole number from 1 to {most}, not '{text}'")
    return int(text)


def names_in(text: str) -> list[str]:
    return [name for name in text.split(",") if name]
