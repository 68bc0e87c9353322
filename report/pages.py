# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages from templates."""

import shutil
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from report.folder import MARK
from report.painting import colour_bar
from report.results import text_of

HERE = Path(__file__).resolve().parent
THREE = tuple(Path("/usr/share/javascript/three") / name  # Debian's libjs-three
              for name in ("three.min.js", "examples/js/controls/OrbitControls.js"))

SIMULATED = "Simulated participants: the program made the ground truth. These scores say nothing about people."


@cache
def environment():
    made = Environment(loader=FileSystemLoader(HERE / "templates"), autoescape=True, undefined=StrictUndefined,
                       trim_blocks=True, lstrip_blocks=True)
    made.globals.update(MARK=MARK)
    return made


def copy_static(folder):
    """Style, scripts, colour bar; three.js where Debian's libjs-three is installed."""
    for file in sorted((HERE / "static").iterdir()):
        shutil.copyfile(file, folder.file(f"static/{file.name}"))
    colour_bar().save(folder.file("static/colourbar.png"))
    colour_bar("diverging").save(folder.file("static/colourbar-difference.png"))
    for file in THREE:
        if file.is_file():
            shutil.copyfile(file, folder.file(f"static/{file.name}"))


class Pages:
    """Renders templates into the report's folder with what every page shows: banners and navigation."""

    def __init__(self, shop, navigation):
        self.shop = shop
        self.templates = environment()
        self.common = {"results": shop.results, "navigation": navigation, "program": text_of(shop.results.record.get("program"))}

    def write(self, path, template, **values):
        """path: within the report; links in templates start with `root`."""
        root = "../" * path.count("/")
        text = self.templates.get_template(template).render(
            path=path, root=root, banners=banners(self.shop.results), **self.common, **values)
        self.shop.file(path).write_text(text, encoding="utf-8")


def banners(results):
    """What every page says at its top: simulated participants, a run that did not end, numbers that cannot be used."""
    said = []
    if results.simulated:
        said.append(SIMULATED)
    if results.state != "finished":
        said.append(f"The run did not end: {results.state}. Scores of shapes that are shown are final; means are of these.")
    return said + results.unusable
