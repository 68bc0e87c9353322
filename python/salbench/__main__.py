# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench`, and `python3 -m salbench`: runs the subcommand of a command line. Errors go to standard
error."""

import errno
import importlib
import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from salbench.commands import FORMER, SUBCOMMANDS, help_text
from salbench.system.console import (
    DEFECT,
    UNUSABLE_ARGUMENTS,
    UNUSABLE_STORAGE,
    Forgiving,
    open_standard_streams,
    warn,
    write_output,
)
from salbench.system.processes import hold_interrupts, raise_interrupts, say_interrupted


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the subcommand of these words, or of the command line; returns its exit status. Only in the second
    case does it set up signals of the process, and name options in messages."""
    if arguments is None:
        hold_interrupts()
        # consistent encoding of names and texts on all systems
        if sys.getfilesystemencoding() != "utf-8":
            os.execv(sys.executable, [sys.executable, "-X", "utf8", *sys.orig_argv[1:]])
    _prepare_streams()
    words = sys.argv[1:] if arguments is None else [*arguments]
    try:
        return _reported(words, arguments is None)
    except KeyboardInterrupt:
        return say_interrupted(words)


def _prepare_streams() -> None:
    open_standard_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="surrogateescape")  # file names may not be UTF-8
    if isinstance(sys.stderr, TextIOWrapper):  # not yet forgiving
        # less than a TextIO, which only some versions of mypy report
        setattr(sys, "stderr", Forgiving(sys.stderr))


def _reported(words: Sequence[str], is_whole_process: bool) -> int:
    """Exit status, after reporting errors."""
    from salbench.system.errors import InputError, StorageError
    from salbench.system.files import LACKING

    try:
        return _carry_out(words, is_whole_process)
    except InputError as error:
        return _fail(UNUSABLE_ARGUMENTS, str(error))
    except StorageError as error:
        return _fail(UNUSABLE_STORAGE, str(error))
    except OSError as error:
        if error.filename is None or error.errno in (*LACKING, errno.EIO):
            return _fail(
                UNUSABLE_STORAGE,
                ": ".join(
                    filter(None, (error.filename and str(error.filename), error.strerror or str(error)))
                ),
            )
        return _fail(UNUSABLE_ARGUMENTS, f"{error.filename}: cannot be read: {error.strerror}")
    except ModuleNotFoundError as error:
        return _fail(
            UNUSABLE_ARGUMENTS, f"{error}; salbench {words[0]} needs it: install it for {sys.executable}"
        )
    except MemoryError:
        return _fail(
            UNUSABLE_STORAGE,
            "out of memory; close other programs, or use fewer threads, items, models or metrics",
        )
    except Exception as error:  # last resort: a known status, and a hint how to report
        from salbench import _core

        said = str(error)  # the engine's message is complete
        is_said = said.startswith(_core.a_defect)
        return _fail(DEFECT, said if is_said else f"{_core.a_defect}: {type(error).__name__}: {said}")


def _carry_out(words: Sequence[str], is_whole_process: bool) -> int:
    name, *others = words or [""]
    if name in ("-h", "--help", "--version"):
        write_output(_version_text() if name == "--version" else help_text())
        return 0
    known = SUBCOMMANDS.get(name)
    if known is None:
        print(_unknown(name), file=sys.stderr)
        return UNUSABLE_ARGUMENTS
    from salbench.commands.parsing import Parser

    module = importlib.import_module(f"salbench.commands.{name if name != 'import' else 'import_'}")
    parser = Parser(name, known)
    module.add_arguments(parser)
    given = parser.parsed(others)
    from salbench.commands.log import say_log  # not needed by help

    say_log()
    if is_whole_process:
        from salbench import _core

        _core.write_options_for_the_command_line()
        raise_interrupts(words, known.ends_at_once)
    return int(module.carry_out(given))


def _version_text() -> str:
    from salbench import _core

    commit = f"commit {_core.commit}, " if _core.commit else ""
    return (
        f"salbench {_core.version}\n{commit}instructions {_core.instructions},"
        f" {', '.join(_core.libraries())}\n"
    )


def _unknown(name: str) -> str:
    """Message on an unknown first word."""
    if name in FORMER:
        return f"error: there is no {name} any more: salbench {FORMER[name]}"
    if not name:
        return "error: a subcommand is required; salbench --help names them"
    from salbench import _core

    what, known = (
        ("option", ["--help", "--version"]) if name.startswith("-") else ("subcommand", [*SUBCOMMANDS])
    )
    return (
        f"error: there is no {what} '{name}';"
        f" {_core.did_you_mean(os.fsencode(name), known, 'salbench --help names them')}"
    )


def _fail(status: int, message: str) -> int:
    for line in message.splitlines():  # for a configuration with several errors
        warn("error", line)
    return status


if __name__ == "__main__":
    sys.exit(main())
