# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages from templates, and the folder that they stand in."""

import shutil
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from report.painting import colour_bar
from report.results import Unusable, text_of
from report.viewer import palette_script

HERE = Path(__file__).resolve().parent
MARK = "salbench report"  # <meta name="generator"> of index.html: a folder that has it may be written again
THREE = tuple(Path("/usr/share/javascript/three") / name  # Debian's libjs-three
              for name in ("three.min.js", "examples/js/controls/OrbitControls.js"))
FOLDERS = ("figures", "data", "shapes", "pictures", "static")


@cache
def environment():
    made = Environment(loader=FileSystemLoader(HERE / "templates"), autoescape=True, undefined=StrictUndefined,
                       trim_blocks=True, lstrip_blocks=True)
    made.globals.update(MARK=MARK)
    return made


def prepare_folder(out):
    """An empty folder for the report. One with other things in it is left alone: Unusable."""
    index = out / "index.html"
    try:
        if out.exists() and not out.is_dir():
            raise Unusable(f"{out}: not a folder; choose another with --to")
        if out.is_dir() and any(out.iterdir()):
            if not (index.is_file() and MARK in index.read_text(encoding="utf-8", errors="replace")[:600]):
                raise Unusable(f"{out}: holds something else than a report; choose another folder with --to")
        out.mkdir(parents=True, exist_ok=True)
        index.write_text(f'<meta name="generator" content="{MARK}"><title>Unfinished</title>')  # the last page replaces it
        for folder in FOLDERS:
            shutil.rmtree(out / folder, ignore_errors=True)
            (out / folder).mkdir(parents=True)
    except OSError as error:
        raise Unusable(f"{out}: cannot be written: {error.strerror}; choose another folder with --to") from None


def copy_static(out):
    """Style, scripts, colour bar; three.js where Debian's libjs-three is installed."""
    for file in sorted((HERE / "static").iterdir()):
        shutil.copyfile(file, out / "static" / file.name)
    (out / "static" / "palette.js").write_text(palette_script(), encoding="utf-8")
    colour_bar().save(out / "static" / "colourbar.png")
    for file in THREE:
        if file.is_file():
            shutil.copyfile(file, out / "static" / file.name)


class Pages:
    """Renders templates into the report's folder with what every page shows: banners and navigation."""

    def __init__(self, shop, navigation):
        self.shop = shop
        self.templates = environment()
        self.common = {"results": shop.results, "navigation": navigation, "banners": banners(shop.results),
                       "program": text_of(shop.results.record.get("program"))}

    def write(self, path, template, **values):
        """path: within the report; links in templates start with `root`."""
        root = "../" * path.count("/")
        text = self.templates.get_template(template).render(path=path, root=root, **self.common, **values)
        (self.shop.out / path).write_text(text, encoding="utf-8")


def banners(results):
    """What every page says at its top: simulated participants, a run that did not end."""
    said = []
    if results.simulated:
        said.append("Simulated participants: the program made the ground truth. These scores say nothing about people.")
    if results.state != "finished":
        said.append(f"The run did not end: {results.state}. Scores of shapes that are shown are final; means are of these.")
    return said
