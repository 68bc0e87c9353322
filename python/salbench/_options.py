# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of the stages in docstrings and signatures: the program's table of them is the only one."""

import inspect
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


def with_options(rows: Iterable[tuple[str, str, str]]) -> Callable[[Function], Function]:
    """Puts (name, default, note) of each option into a function's signature, and below "Options" in its docstring."""

    def documented(function: Function) -> Function:
        lines, parameters = [], []
        for name, default, note in rows:
            lines += [f"    {name} : {type(default_from(default)).__name__}, default {default}", f"        {note}"]
            parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default_from(default)))
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        function.__signature__ = signature.replace(parameters=own + parameters)  # type: ignore[attr-defined]
        function.__doc__ = (function.__doc__ or "").replace("    **options\n", "\n".join(lines) + "\n")
        return function

    return documented
