# SPDX-License-Identifier: GPL-3.0-or-later
"""What every element is built from and writes to: results, exports, the paper's figures, and the folder of the report."""

import os
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from salbench.pages.blocks import Plot
from salbench.report import crew, drawing, kept, names, statistics, style
from salbench.report.drawing import Drawing
from salbench.report.exports import Shapes
from salbench.report.folder import Folder
from salbench.report.kept import Facts
from salbench.report.results import Frame, Results, write_csv

if TYPE_CHECKING:
    from salbench.report.gallery import Painter
    from salbench.report.shape_pages import Scores

# Of what draws figures: those that something else drew are drawn again.
LOOKS = kept.digest(kept.digest_of_code(drawing, style), version("matplotlib"), numpy.__version__)


@dataclass
class Workshop:
    results: Results
    folder: Folder
    shapes: Shapes
    protocols: dict[str, dict[str, Any]] = field(default_factory=dict)  # protocol -> its complete configuration, scalars as text
    items: dict[str, str] = field(default_factory=dict)  # item -> class of every shape that has a page
    examples: tuple[str, ...] = ()          # meshes that the user wants to see
    painters: "list[Painter] | None" = None  # of the shapes with pictures; made when first needed
    scores: "Scores | None" = None          # made when first needed
    other: Results | None = None            # of the run to compare with
    processes: int = 1                      # that draw
    drawn: dict[str, Facts] = field(default_factory=dict)  # shape name -> of its files (shape_files.draw_all)
    waiting: list[tuple[str, tuple[Any, ...]]] = field(default_factory=list)  # figures that are yet to be drawn: (name, (drawing, key))

    def __post_init__(self) -> None:
        self.models = statistics.models(self.results)
        self.colours = names.colours(self.models)
        self.dashes = names.dashes(self.models)
        # Each name as a part of file names.
        self.shape_files = names.file_names([*self.items, *(shape.name for shape in self.shapes.shapes.values())])
        self.model_files = names.file_names(["ground truth", *self.models, *self.shapes.models])
        self.metric_files = names.file_names(self.results.metrics)

    def plot(self, name: str, figure: Any, data: Frame, alt: str, caption: str) -> Plot:
        """Writes a figure as SVG and PDF with the plotted numbers beside it."""
        self.draw(name, figure)
        write_csv(data, self.file(f"data/{name}.csv"))
        return Plot(name, alt, round(figure.get_figwidth() * 96), caption)

    def draw(self, name: str, figure: Any) -> None:
        """Has a figure drawn as SVG and PDF, by draw_figures; nothing is to be done where it shows the same as before."""
        if not isinstance(figure, Drawing):
            self._save((name, figure))
            return
        content = figure.key()
        key = content and kept.digest(name, content, LOOKS)
        if key is None or self.folder.find(key) is None:
            self.waiting.append((name, (name, figure, key)))

    def draw_figures(self) -> None:
        """Draws what `draw` left waiting, on all processes."""
        if self.waiting:
            style.apply()  # once for all processes
        for (_, (_, _, key)), written in zip(self.waiting, crew.each(self._save, self.waiting, self.processes)):
            self.folder.names.update(written)
            if key:
                self.folder.add(key, written, None)
        self.waiting.clear()

    def _save(self, task: tuple[Any, ...]) -> list[str]:
        name, figure = task[:2]
        written = [f"figures/{name}.svg", f"figures/{name}.pdf"]
        parts = [path.with_name(f"{path.name}.part") for path in map(self.file, written)]
        style.save(figure.real() if isinstance(figure, Drawing) else figure, *parts)
        for part in parts:
            os.replace(part, part.with_suffix(""))
        return written

    def file(self, name: str) -> Path:
        """The path of a file of the report, to be written now."""
        return self.folder.file(name)

    def page_of(self, item: str) -> str:
        """The path of the page of an item within the report; empty if it has none."""
        return f"shapes/{self.shape_files[item]}.html" if item in self.items else ""
