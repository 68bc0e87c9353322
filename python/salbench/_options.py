# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of the stages in docstrings and signatures: the program's table of them is the only one."""

import inspect
import re
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])
Value = bool | int | float | str


def default_from(text: str) -> Value:
    """The value that a configuration's text stands for."""
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


Row = tuple[str, str, str]  # name, default, note


def option_lines(rows: Iterable[Row], indent: str) -> str:
    """The options as parameters of a docstring."""
    return "".join(f"{indent}{name} : {type(default_from(default)).__name__}, default {default}\n{indent}    {note}\n"
                   for name, default, note in rows)


def with_options(rows: Iterable[Row]) -> Callable[[Function], Function]:
    """Puts (name, default, note) of each option into a function's signature, and below "Parameters" in its docstring."""
    rows = list(rows)

    def documented(function: Function) -> Function:
        parameters = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default_from(default))
                      for name, default, _ in rows]
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        function.__signature__ = signature.replace(parameters=own + parameters)  # type: ignore[attr-defined]
        return with_options_of("**options", rows)(function)

    return documented


def with_options_of(place: str, rows: Iterable[Row]) -> Callable[[Function], Function]:
    """Puts options in place of a line of a docstring; the signature stays, where they depend on other arguments."""
    rows = list(rows)

    def documented(function: Function) -> Function:
        # Since Python 3.13 docstrings come without the indentation of their source.
        function.__doc__ = re.sub(rf"^( *){re.escape(place)}\n", lambda found: option_lines(rows, found[1]),
                                  function.__doc__ or "", flags=re.MULTILINE)
        return function

    return documented
