# SPDX-License-Identifier: GPL-3.0-or-later
"""What every element is built from and writes to: results, exports, the paper's figures, and the folder of the report."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from salbench.pages.blocks import Plot
from salbench.report import crew, names, statistics, style
from salbench.report.drawing import Drawing
from salbench.report.exports import Shape, Shapes
from salbench.report.folder import Folder
from salbench.report.painter import Painter
from salbench.report.results import Frame, Shown
from salbench.report.shape_scores import Scores


@dataclass
class Workshop:
    results: Shown
    folder: Folder
    shapes: Shapes
    protocols: dict[str, dict[str, Any]] = field(default_factory=dict)  # protocol -> its complete configuration, scalars as text
    items: dict[str, str] = field(default_factory=dict)  # item -> class of every shape that has a page
    examples: tuple[str, ...] = ()          # meshes that the user wants to see
    processes: int = 1                      # that draw
    picks: bool = False                     # are painted on the ground truth
    lacking: str = ""                       # why no export could be made of what the cache has
    viewer: bool = True                     # False: no coordinates, faces or values of shapes are written
    pictures: dict[str, dict[tuple[str, str], str]] = field(default_factory=dict)  # shape name -> (model, when) -> path (shape_files.draw_all)
    scripts: dict[str, str] = field(default_factory=dict)  # shape name -> of the viewer, beside the pages of shapes; "" for none
    waiting: list[tuple[str, Drawing]] = field(default_factory=list)  # figures yet to be drawn, with paths without extensions

    def __post_init__(self) -> None:
        self.models = statistics.models(self.results)
        self.looks = names.looks(self.models)
        # Each name as a part of file names.
        self.shape_files = names.file_names([*self.items, *(shape.name for shape in self.shapes.shapes.values())])
        self.model_files = names.file_names(["ground truth", *self.models, *self.shapes.models])
        self.metric_files = names.file_names(self.results.metrics)

    @cached_property
    def scores(self) -> Scores:
        return Scores(self.results)

    def painter(self, shape: Shape) -> Painter:
        return Painter(shape, self.pictures[shape.name], self.picks)

    @cached_property
    def painters(self) -> list[Painter]:
        """Of all shapes with a picture of their ground truth."""
        return [painter for painter in map(self.painter, self.shapes.shapes.values()) if painter.has("ground truth")]

    def plot(self, name: str, drawing: Drawing, data: Frame, alt: str, caption: str) -> Plot:
        """A figure as SVG and PDF with the plotted numbers beside it."""
        file = self.draw(name, drawing)
        self.write(f"data/{name}.csv", data.to_csv(index=False, lineterminator="\n"))
        return Plot(name, file, alt, round(drawing.size[0] * 96), caption)

    def draw(self, name: str, drawing: Drawing) -> str:
        """Has a figure drawn as SVG and PDF, by draw_figures, unless its files are there. Returns their path without the extension."""
        file = f"figures/{name}-{drawing.digest()}"
        self.folder.add([f"{file}.svg", f"{file}.pdf"])
        if not (self.folder.has(f"{file}.svg") and self.folder.has(f"{file}.pdf")):
            self.waiting.append((file, drawing))
        return file

    def draw_figures(self) -> None:
        """Draws what `draw` left waiting, on all processes."""
        if self.waiting:
            style.apply()  # once for all processes
        crew.each(self._save, self.waiting, self.processes)
        self.waiting.clear()

    def _save(self, task: tuple[str, Drawing]) -> None:
        file, drawing = task
        for extension, data in zip(("svg", "pdf"), style.save(drawing.real())):
            self.write(f"{file}.{extension}", data)

    def write(self, name: str, data: str | bytes) -> None:
        """A file of the report."""
        self.folder.write(name, data)

    def page_of(self, item: str) -> str:
        """The path of the page of an item within the report; empty if it has none."""
        return f"shapes/{self.shape_files[item]}.html" if item in self.items else ""
