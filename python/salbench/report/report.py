# SPDX-License-Identifier: GPL-3.0-or-later
"""A report in the making: its sources (results, exports and the paper's figures), and its folder."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

from markupsafe import Markup

from salbench.conclusions import glossary, tables
from salbench.pages import rendering
from salbench.pages.blocks import Plot
from salbench.pages.looks import looks_of
from salbench.pages.viewer_parts import three_js
from salbench.report import drawing, names, statistics, style
from salbench.report.drawing import Drawing
from salbench.report.exports import Shape, Shapes
from salbench.report.folder import Folder
from salbench.report.painting import colour_bar
from salbench.report.results import Frame, Shown
from salbench.report.statistics import Scores
from salbench.runs import conclusions_file
from salbench.system.progress import Told, nothing

HERE = Path(__file__).parent
RECORDINGS = "recording.html"
COMPUTED = "computed from recordings of gaze"


@dataclass
class Report:
    results: Shown
    folder: Folder
    shapes: Shapes
    items: dict[str, str] = field(default_factory=dict)  # item -> class, for every shape that has a page
    examples: tuple[str, ...] = ()  # meshes that the user selected
    processes: int = 1  # number that draw
    picks: bool = False  # True: paints picks, or fixations, on the ground truth
    lacking: str = ""  # reason why the cache gave no export
    viewer: bool = True  # False: no coordinates, faces or values of shapes are written
    told: Told = nothing  # reports the progress of drawing
    pages: "Sequence[Page]" = ()  # in the navigation
    # figures to draw, with paths without extensions
    waiting: list[tuple[str, Drawing]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.models = statistics.models(self.results)
        self.looks = looks_of(self.models)
        left_out = statistics.left_out(self.results)
        for shape in self.shapes.shapes.values():
            shape.left_out = left_out.get(shape.item, ())
        # Names for parts of file names.
        self.shape_files = names.file_names(
            [*self.items, *(shape.name for shape in self.shapes.shapes.values())]
        )
        self.model_files = names.file_names(["ground truth", *self.models, *self.shapes.models])
        self.metric_files = names.file_names(self.results.metrics)
        # Titles explain the letters of models. Maps from outside, and tables without a run, may use the same
        # letter for another model.
        own = (
            [model for model in self.models if model not in self.results.evaluated]
            if self.results.record
            else []
        )
        self.titles = glossary.titles(own, self.results.metrics)
        self._templates = rendering.environment(HERE, self.titles, self.results.mine)

    @cached_property
    def scores(self) -> Scores:
        return Scores(self.results)

    def alt(self, shape: Shape, what: str, label: str) -> str:
        """Alternative text of a picture."""
        dots = ""
        if what == "ground truth" and self.picks and shape.has_gaze:
            dots = "; dots: where people looked"
        elif what == "ground truth" and self.picks and shape.has_picks:
            dots = "; dots: what participants picked"
        return f"{label}: {shape}{dots}"

    def plot(self, name: str, figure: Drawing, data: Frame, alt: str, caption: str) -> Plot:
        """Returns a figure as SVG and PDF, with the plotted numbers beside it."""
        file = self.draw(name, figure)
        self.folder.write(f"data/{name}.csv", data.to_csv(index=False, lineterminator="\n"))
        return Plot(name, file, alt, round(figure.size[0] * 96), caption)

    def draw(self, name: str, figure: Drawing) -> str:
        """Queues a figure for draw_figures, as SVG and PDF, unless its files exist. Returns their path
        without the extension."""
        file = f"figures/{name}-{figure.digest()}"
        self.folder.add([f"{file}.svg", f"{file}.pdf"])
        if not (self.folder.has(f"{file}.svg") and self.folder.has(f"{file}.pdf")):
            self.waiting.append((file, figure))
        return file

    def draw_figures(self) -> None:
        """Draws the figures queued by `draw`."""
        if self.waiting:
            style.apply()  # once for all processes
        self.draw_each("figures", self._save, self.waiting)

    def draw_each(self, what: str, work: Callable[[Any], None], tasks: Sequence[Any]) -> None:
        """Runs tasks on all processes."""
        if tasks:
            self.folder.begin_drawings()
            drawing.each(
                work, tasks, self.processes, lambda done: self.told(f"drawing {what}", done, len(tasks), "")
            )

    def _save(self, task: tuple[str, Drawing]) -> None:
        file, figure = task
        for extension, data in zip(("svg", "pdf"), style.save(figure.real())):
            self.folder.put(f"{file}.{extension}", data)

    def page_of(self, item: str) -> str:
        """Path of an item's page within the report; empty if it has none."""
        return f"shapes/{self.shape_files[item]}.html" if item in self.items else ""

    def write_page(self, path: str, template: str, **values: Any) -> None:
        """Writes a page. path: within the report; links in templates start with `root`."""
        self.folder.write(
            path,
            self._templates.get_template(template).render(
                path=path,
                root="../" * path.count("/"),
                banners=[
                    self._with_link(banner, "../" * path.count("/")) for banner in banners(self.results)
                ],
                results=self.results,
                navigation=[(page.path, page.label) for page in self.pages],
                program=self.results.record.get("program", ""),
                **values,
            ),
        )

    def _with_link(self, banner: str, root: str) -> str:
        """A banner for computed ground truth: refers to the page of recordings in place of the options, which
        are listed there."""
        said, is_computed, _ = banner.partition(COMPUTED)
        if not is_computed or RECORDINGS not in {page.path for page in self.pages}:
            return banner
        return Markup('{}{}: <a href="{}">how</a>').format(
            said.replace("TRUTH:", "Ground truth:"), COMPUTED, root + RECORDINGS
        )

    def copy_static(self) -> None:
        """Copies style, scripts and colour bars; for the viewer also three.js, if installed."""
        for place in (rendering.HERE, HERE):
            for file in sorted((place / "static").iterdir()):
                self.folder.write(f"static/{file.name}", file.read_bytes())
        for name, bar in (
            ("colourbar", colour_bar("palette")),
            ("colourbar-difference", colour_bar("diverging")),
        ):
            made = BytesIO()
            bar.save(made, "PNG")
            self.folder.write(f"static/{name}.png", made.getvalue())
        with suppress(FileNotFoundError):
            for file in three_js() if self.viewer else ():
                self.folder.write(f"static/{file.name}", file.read_bytes())


@dataclass(frozen=True)
class Page:
    path: str
    label: str  # in the navigation
    title: str
    lead: str  # one line on the content
    write: "Callable[[Report, Page], None]"
    is_there: Callable[[Report], Any] = lambda report: True


def banners(results: Shown) -> list[str]:
    """Banners at the top of every page: simulated participants, an unfinished run, unusable numbers."""
    said = []
    if results.simulated:
        said.append(rendering.SIMULATED)
    said += [remark for remark in tables.of_truth(results.remarks) if not remark.startswith("SIMULATED")]
    if results.state != "finished" and not results.is_of_table:
        said.append(
            f"The run did not end: {results.state}. Scores of shapes that are shown are final; means are of"
            " these."
        )
    if changed := conclusions_file.changed(results.folder):
        said.append(
            f"{', '.join(changed)} changed after conclusions were drawn: what stands here is not all of one"
            " run. salbench conclude draws them again."
        )
    return said + results.unusable
