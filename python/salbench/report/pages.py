# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages: what they are called, and how they come from templates."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from salbench.conclusions import glossary, tables
from salbench.pages import rendering
from salbench.pages.viewer_parts import three_js
from salbench.report.folder import Folder
from salbench.report.painting import colour_bar
from salbench.report.results import Shown
from salbench.report.workshop import Workshop
from salbench.runs import conclusions_file

HERE = Path(__file__).parent


def copy_static(folder: Folder, viewer: bool) -> None:
    """Style, scripts, colour bars; for the viewer three.js, where it is installed."""
    for place in (rendering.HERE, HERE):
        for file in sorted((place / "static").iterdir()):
            folder.write(f"static/{file.name}", file.read_bytes())
    for name, bar in (("colourbar", colour_bar("palette")), ("colourbar-difference", colour_bar("diverging"))):
        made = BytesIO()
        bar.save(made, "PNG")
        folder.write(f"static/{name}.png", made.getvalue())
    with suppress(FileNotFoundError):
        for file in three_js() if viewer else ():
            folder.write(f"static/{file.name}", file.read_bytes())


@dataclass(frozen=True)
class Page:
    path: str
    label: str   # in the navigation
    title: str
    lead: str    # what a reader finds there
    write: "Callable[[Pages, Page], None]"
    is_there: Callable[[Workshop], Any] = lambda shop: True


class Pages:
    """Renders templates into the report's folder with what every page shows: banners and navigation."""

    def __init__(self, shop: Workshop, present: Sequence[Page]) -> None:
        self.shop, self.present = shop, present
        self.titles = titles(shop.results, shop.models)
        self.templates = rendering.environment(HERE, self.titles, shop.results.mine)
        self.common = {"results": shop.results, "navigation": [(page.path, page.label) for page in present], "program": shop.results.record.get("program", "")}

    def write(self, path: str, template: str, **values: Any) -> None:
        """path: within the report; links in templates start with `root`."""
        root = "../" * path.count("/")
        text = self.templates.get_template(template).render(
            path=path, root=root, banners=banners(self.shop.results), **self.common, **values)
        self.shop.write(path, text)


def titles(results: Shown, models: list[str]) -> dict[str, str]:
    """What letters in tables mean. Maps of anybody's may have the name of a model of the program's; so may a table without a run."""
    own = [model for model in models if model not in results.evaluated] if results.record else []
    return glossary.titles(own, results.metrics)


def banners(results: Shown) -> list[str]:
    """What every page says at its top: simulated participants, a run that did not end, numbers that cannot be used."""
    said = []
    if results.simulated:
        said.append(rendering.SIMULATED)
    said += [remark for remark in tables.of_truth(results.remarks) if not remark.startswith("SIMULATED")]
    if results.state != "finished":
        said.append(f"The run did not end: {results.state}. Scores of shapes that are shown are final; means are of these.")
    if changed := conclusions_file.changed(results.folder):
        said.append(f"{', '.join(changed)} changed after conclusions were drawn: what stands here is not all of one run. "
                    "salbench conclude draws them again.")
    return said + results.unusable
