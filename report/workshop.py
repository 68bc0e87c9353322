# SPDX-License-Identifier: GPL-3.0-or-later
"""What every element is built from and writes to: results, exports, the paper's figures, and the folder of the report."""

from dataclasses import dataclass, field

from report import names, statistics, style
from report.blocks import Plot
from report.folder import Folder
from report.results import Results, write_csv


@dataclass
class Workshop:
    results: Results
    folder: Folder
    shapes: object                                # exports.Shapes
    protocols: dict = field(default_factory=dict)  # protocol -> its complete configuration, scalars as text
    items: dict = field(default_factory=dict)      # item -> class of every shape that has a page
    examples: tuple = ()                          # meshes that the user wants to see
    painted: set = field(default_factory=set)     # pictures that were written
    painters: list = None                         # of the shapes with pictures; made when first needed
    scores: object = None                         # shape_pages.Scores; made when first needed

    other: Results = None                         # of the run to compare with

    def __post_init__(self):
        self.models = statistics.models(self.results)
        self.colours = names.colours(self.models)
        self.dashes = names.dashes(self.models)
        # Each name as a part of file names.
        self.shape_files = names.file_names([*self.items, *(shape.name for shape in self.shapes.shapes.values())])
        self.model_files = names.file_names(["ground truth", *self.models, *self.shapes.models])
        self.metric_files = names.file_names(self.results.metrics)

    def plot(self, name, figure, data, alt, caption):
        """Writes a figure as SVG and PDF with the plotted numbers beside it."""
        self.draw(name, figure)
        write_csv(data, self.file(f"data/{name}.csv"))
        return Plot(name, alt, round(figure.get_figwidth() * 96), caption)

    def draw(self, name, figure):
        """Writes a figure as SVG and PDF."""
        style.save(figure, self.file(f"figures/{name}.svg"), self.file(f"figures/{name}.pdf"))

    def file(self, name):
        """The path of a file of the report, to be written now."""
        return self.folder.file(name)

    def page_of(self, item):
        """The path of the page of an item within the report; empty if it has none."""
        return f"shapes/{self.shape_files[item]}.html" if item in self.items else ""
