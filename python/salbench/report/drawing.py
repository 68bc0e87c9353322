# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure of Matplotlib that is yet to be drawn: a function, and what it draws. Both give a key, so that a figure that shows the same as
before is not drawn again, and what is to be drawn can be, in any process."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, is_dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy
import pandas

from salbench.report import names, style
from salbench.report.folder import digest


@dataclass(frozen=True)
class Drawing:
    draw: Callable[..., None]   # of a module: takes an empty figure and the arguments, and reads nothing else
    arguments: tuple[Any, ...]
    size: tuple[float, float]   # width and height, inches
    layout: Literal["constrained"] | None = "constrained"

    def key(self) -> str:
        """A digest of what is drawn, and of the code and libraries that draw it. TypeError for an argument without a content that could be
        told."""
        code = code_of(names, style, sys.modules[self.draw.__module__])
        return digest(code, version("matplotlib"), numpy.__version__, self.draw.__qualname__, *told((self.size, self.layout, self.arguments)))

    def real(self) -> Any:
        from matplotlib.figure import Figure

        style.apply()
        figure = Figure(figsize=self.size, layout=self.layout)
        self.draw(figure, *self.arguments)
        return figure


@cache
def code_of(*modules: ModuleType) -> str:
    """Of their source files: what other code drew is drawn again."""
    return digest(*(Path(str(module.__file__)).read_bytes() for module in modules))


def told(value: Any) -> Iterator[str | bytes]:
    """Texts and bytes that differ where values differ."""
    if value is None or isinstance(value, (str, bytes, bool, int, float, numpy.generic)):
        yield f"{type(value).__name__} {value!r}"
    elif isinstance(value, numpy.ndarray) and value.dtype != object:
        yield f"{value.dtype.str} {value.shape}"
        yield value.tobytes()
    elif isinstance(value, pandas.DataFrame):
        yield from told({name: value[name].to_numpy() for name in value})
    elif isinstance(value, dict):
        yield from told(list(value.items()))
    elif isinstance(value, (list, tuple)) or isinstance(value, numpy.ndarray):
        yield f"{type(value).__name__} {len(value)}"
        for entry in value:
            yield from told(entry)
    elif is_dataclass(value):
        yield from told(vars(value))
    else:
        raise TypeError(f"a figure is drawn of a {type(value).__name__}, which has no content that could be told")
