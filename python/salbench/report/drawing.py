# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure of Matplotlib that is yet to be drawn: a function, and what it draws. Its digest is part of the name of its file, so that a figure
that shows the same as before is not drawn again, and what is to be drawn can be, in any process."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from pickle import Pickler
from typing import Any, Literal

import numpy
import PIL
from PIL import features

from salbench.pages import rendering
from salbench.report import style
from salbench.report.folder import digest


@dataclass(frozen=True)
class Drawing:
    draw: Callable[..., None]   # of a module: takes an empty figure and the arguments, and reads nothing else
    arguments: tuple[Any, ...]
    size: tuple[float, float]   # width and height, inches
    layout: Literal["constrained"] | None = "constrained"

    def digest(self) -> str:
        """Digest of what is drawn, and of the code and libraries that draw it."""
        content = BytesIO()
        pickler = Pickler(content, 5)
        pickler.fast = True  # equal values give equal bytes, whether or not they are the same object
        pickler.dump(self)
        return digest(code(), content.getvalue())

    def real(self) -> Any:
        from matplotlib.figure import Figure

        style.apply()
        figure = Figure(figsize=self.size, layout=self.layout)
        self.draw(figure, *self.arguments)
        return figure


@cache
def code() -> str:
    """Digest of all that draws: what another version drew is drawn again."""
    sources = [path for folder in (Path(__file__).parent, rendering.HERE) for path in sorted(folder.glob("*.py"))]
    libraries = (version("matplotlib"), numpy.__version__, PIL.__version__, str(features.version("webp")), zlib.ZLIB_RUNTIME_VERSION)
    return digest(*libraries, *(path.read_bytes() for path in (*sources, rendering.HERE / "static/palette.js")))
