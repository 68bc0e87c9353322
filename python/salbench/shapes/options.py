# SPDX-License-Identifier: GPL-3.0-or-later
"""Docstrings and signatures of compiled functions: adds shared arguments, described only here, and options
from the program's table."""

import inspect
import re
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from salbench import _core

Function = TypeVar("Function", bound=Callable[..., Any])
Value = bool | int | float | str
Row = tuple[str, str, str]  # name, default, note

_SEED = (
    "seed, item : int, str\n    Random numbers are those of a run with this seed for a shape of this name.\n"
)
ARGUMENTS = {
    "points": "points : (n, 3) array\n    Positions, in any unit.\n",
    "faces": "faces : (m, 3) array of int\n    Corners.\n",
    "normals": "normals : (n, 3) array\n    Unit normals.\n",
    "picks": (
        "picks : (p,) array of int, or a sequence of them\n"
        "    Marked points, 0 to n - 1; one array, or one per participant.\n"
    ),
    "seed": _SEED,
    "item": _SEED,
    "threads": (
        "threads : int or None, default 1\n    Number of threads; None: all cores that the process may use."
        " The result does not depend on it.\n"
    ),
}
SECTIONS = ("Parameters", "Returns", "Raises", "Notes", "References", "Examples")


def default_from(text: str) -> Value:
    """Value of a configuration's text."""
    if text in ("true", "false"):
        return text == "true"
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return text.strip('"')


def option_lines(rows: Iterable[Row], indent: str = "") -> str:
    """Formats options as parameters of a docstring."""
    return "".join(
        f"{indent}{name} : {type(default_from(default)).__name__}, default {default}\n{indent}    {note}\n"
        for name, default, note in rows
    )


def documented(function: Function, rows: Iterable[Row] | None = None) -> Function:
    """Decorator that replaces `**options` in a function's signature by the options, and completes its
    docstring.

    The docstring itself describes arguments that are not in ARGUMENTS, or differ from it, and Raises unless
    it is just an invalid argument. If options depend on other arguments, it has an entry `**options`, in
    which a line `**NAME` is replaced by those of the compiled function NAME. `rows`: default: the options of
    the compiled function of the same name.
    """
    rows = list(_core.options.get(function.__name__, ()) if rows is None else rows)
    signature = inspect.signature(function)
    head, *texts = re.split(r"^(\w+)\n-+\n", inspect.cleandoc(function.__doc__ or ""), flags=re.MULTILINE)
    sections = {"Raises": "ValueError\n    An invalid argument.", **dict(zip(texts[::2], texts[1::2]))}
    own = _entries(sections.get("Parameters", ""))
    taken = [own.get(name, ARGUMENTS.get(name, "")) for name in signature.parameters]
    sections["Parameters"] = "".join(dict.fromkeys(taken)) + option_lines(rows)
    text = head + "\n\n".join(
        f"{name}\n{'-' * len(name)}\n{sections[name].strip()}" for name in SECTIONS if name in sections
    )
    function.__doc__ = re.sub(
        r"^( +)\*\*(\w+)\n",
        lambda found: option_lines(_core.options[found[2]], found[1]),
        text + "\n",
        flags=re.MULTILINE,
    )
    if "options" not in own:
        parameters = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        parameters += [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default_from(default))
            for name, default, _ in rows
        ]
        function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return function


def _entries(parameters: str) -> dict[str, str]:
    """Entries of a docstring section by name; several names may share one, as in "seed, item : int, str"."""
    entries = re.findall(r"^\S.*\n(?:(?: .*)?\n)*", parameters.rstrip() + "\n", re.MULTILINE)
    return {
        name.lstrip("*"): entry
        for entry in entries
        for name in entry.splitlines()[0].partition(" :")[0].split(", ")
    }
