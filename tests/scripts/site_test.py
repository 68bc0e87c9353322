# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/site over toys: its pages lead to files and load nothing from elsewhere, nothing of the data is in them, and the reference of its
documentation has what the program has."""

import csv
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path
from unittest import mock
from urllib.parse import unquote, urlsplit

import matplotlib.font_manager  # noqa: F401  or each report would look for fonts, in a folder of its own
import numpy as np
import salbench
import salbench.report.report  # noqa: F401  and with it libraries that each command would import
from salbench.commands import SUBCOMMANDS
from salbench.conclusions import floors

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/leaderboard"), str(ROOT / "tests/report")]

import browser  # noqa: E402
import toy  # noqa: E402
from tests.support import forked  # noqa: E402
from tests.support.without_figures import never_drawn  # noqa: E402

SCRIPT = ["/usr/bin/python3", "-B", ROOT / "scripts/site"]
TEXTS = (".html", ".js", ".css", ".csv", ".tex", ".txt", ".svg", ".yaml")


class Links(HTMLParser):
    """(tag, address) of all that a page links to or loads."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found += [(tag, value) for name, value in attrs if name in ("href", "src", "data-src", "poster") and value]


def lines_of(path):
    return path.read_text(encoding="utf-8").splitlines()


@unittest.skipIf(subprocess.run(["/usr/bin/python3", "-c", "import furo, myst_parser, sphinx"], capture_output=True).returncode,
                 "Sphinx is not here: scripts/setup docs")
class SiteTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="toy site ")))
        cls.data, cls.site = cls.folder / "data", cls.folder / "site"
        cls.data.mkdir()
        cls.enterClassContext(mock.patch("salbench.report.shape_files.METHOD", 0))  # pictures with the least effort
        cls.enterClassContext(forked.named(cls.folder, before=never_drawn))
        made = toy.Toy(cls.folder)  # six meshes: enough to name who leads
        made.config = ROOT / "configs/protocols/schelling.yaml"
        submitted = made.submit("G0", 0)
        assert submitted.returncode == 0, submitted.stderr
        (made.submissions / "bad.zip").write_bytes(b"PK")
        (cls.data / "submissions").mkdir()
        shutil.move(made.submissions, cls.data / "submissions/schelling")
        shutil.move(made.data, cls.data / "SchellingData")
        for part, ending in (("Meshes", ".off"), ("Distributions", ".val"), ("RawData", "_0.pid")):  # two: too few
            (cls.data / "eyetracking" / part).mkdir(parents=True)
            for mesh, name in ((1, "cow"), (2, "horse")):
                shutil.copy(cls.data / f"SchellingData/{part}/{mesh}{ending}", cls.data / f"eyetracking/{part}/{name}{ending}")
        cls.done = cls.made(cls.site)
        assert cls.done.stdout, cls.done.stderr

    @classmethod
    def made(cls, site):
        return subprocess.run([*SCRIPT, cls.data, site, cls.folder / "cache"], capture_output=True, text=True,
                              env=os.environ | {"SALBENCH_PROGRAM": str(cls.folder / "salbench")})

    def table(self, board, name):
        with open(self.site / f"leaderboards/{board}/data/{name}.csv", encoding="utf-8", newline="") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def files(self, *endings):
        return [path for path in sorted(self.site.rglob("*")) if path.is_file() and (not endings or path.suffix in endings)]

    def test_the_front_page_says_who_leads_from_the_tables(self):
        page = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", "", (self.site / "index.html").read_text(encoding="utf-8")))
        self.assertIn("How well does a program predict which points of a shape people find important?", page)
        self.assertIn("A benchmark of 3D saliency models. Each is scored by one protocol", page)
        for name in ("auc", "nss", "lcc"):
            rows = [row for row in self.table("schelling", "compact") if row["metric"] == name and not floors.role(row["model"])]
            best = max(rows, key=lambda row: float(row["mean"]))
            shown = " ".join([best["model"], *(f"{float(best[key]):.3f}" for key in ("mean", "low")), f"to {float(best['high']):.3f}"])
            self.assertIn(shown, page.replace("−", "-"))
            leaders = next(row["leaders"] for row in self.table("schelling", "leaders") if row["metric"] == name).split(", ")
            self.assertIn(", ".join(f"{model} {floors.role(model)}".strip() for model in leaders), page)
        self.assertIn("2 units (mesh) are too few to name who leads", page)

    def test_every_link_leads_to_a_file_of_the_site(self):
        pages = self.files(".html")
        kinds = {path.relative_to(self.site).parts[0] for path in pages}
        self.assertEqual(kinds, {"index.html", "docs", "report", "leaderboards"})
        for page in pages:
            for tag, address in Links(page.read_text(encoding="utf-8")).found:
                parts = urlsplit(address)
                if parts.scheme:
                    self.assertTrue(parts.scheme in ("http", "https") and tag == "a" or parts.scheme in ("data", "mailto"), (page, address))
                else:
                    self.assertFalse(parts.netloc or parts.path.startswith("/"), (page, address))
                    self.assertTrue((page.parent / unquote(parts.path)).exists(), (page, address))

    def test_the_reference_of_the_documentation_is_complete(self):
        def page(name):
            return html.unescape(re.sub(r"<[^>]*>", "", (self.site / f"docs/reference/{name}.html").read_text(encoding="utf-8")))

        commands = page("commands")
        self.assertEqual(len(SUBCOMMANDS), 13)
        for name in SUBCOMMANDS:
            said = subprocess.run([self.folder / "salbench", name, "--help"], capture_output=True, text=True).stdout
            for option in re.findall(r"^  (--[a-z-]+)", said, flags=re.M):
                self.assertIn(option, commands.split(f"salbench {name} [OPTIONS]")[1].split("[OPTIONS]")[0], name)
        metrics, models, python = map(page, ("metrics", "models", "python"))
        self.assertEqual([row.name for row in salbench.metrics.table() if row.help not in metrics], [])
        self.assertEqual([note for row in salbench.models.table() for _, _, note in row.options if note not in models], [])
        self.assertEqual([name for name in salbench.__all__ if name[0] != "_" and f"salbench.{name}" not in python], ["metrics", "models"])

    def test_a_broken_link_of_the_documentation_is_an_error(self):
        source = self.folder / "source"
        source.mkdir()
        shutil.copy(ROOT / "docs/conf.py", source)
        (source / "index.md").write_text("# Start\n\n[x](nothing.md#here)\n")
        line = ["/usr/bin/python3", "-B", "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "dummy", source, self.folder / "broken"]
        done = subprocess.run(line, capture_output=True, text=True)
        self.assertEqual((done.returncode, "nothing.md" in done.stderr), (1, True), done.stderr)

    def test_nothing_names_a_folder_of_this_machine(self):
        for path in self.files(*TEXTS):
            text = path.read_text(encoding="utf-8")
            for place in (tempfile.gettempdir() + "/", str(ROOT)):
                self.assertNotIn(place, text, path)

    def test_nothing_of_the_data_is_in_it(self):
        """Neither files nor lines of theirs nor coordinates in binary: the report is without the viewer."""
        texts = {path: path.read_text(encoding="utf-8") for path in self.files(*TEXTS)}
        bytes_of = {path: path.read_bytes() for path in self.files()}
        for source in (path for path in self.data.rglob("*") if path.is_file() and path.suffix != ".zip"):
            self.assertNotIn(source.read_bytes(), bytes_of.values(), source)
            lines = lines_of(source)
            if source.suffix == ".off":
                vertices = np.array([line.split() for line in lines[2:2 + int(lines[1].split()[0])]], float)
                for kind in ("<f4", "<f8"):
                    for values in (vertices.astype(kind).tobytes()[:48], vertices.T.astype(kind).tobytes()[:48]):
                        self.assertEqual([path for path, data in bytes_of.items() if values in data], [], source)
                sought = [line for line in lines[2:] if len(line) > 15]
            else:
                sought = ["\n".join(lines[:4])]
            self.assertTrue(sought, source)
            for line in sought:
                self.assertEqual([path for path, text in texts.items() if line in text], [], source)
        self.assertEqual([path for path in bytes_of if path.name == "three.min.js" or path.match("report/shapes/*.js")], [])
        self.assertTrue(self.files(".webp"), "pictures are there")

    @browser.needs_browser
    def test_it_opens_from_disk(self):
        window = browser.start()
        self.addCleanup(window.quit)
        for name in ("index.html", "docs/index.html", "report/index.html", "report/gallery.html", "report/shapes/1.html", "leaderboards/schelling/index.html"):
            window.get((self.site / name).as_uri())
            self.assertEqual(browser.console_errors(window), [], name)
        self.assertEqual([address for address in browser.requests(window) if not address.startswith(("file:", "data:"))], [])

    @browser.needs_browser
    def test_a_menu_chooses_by_ground_truth(self):
        window = browser.start()
        self.addCleanup(window.quit)
        window.get((self.site / "index.html").as_uri())

        def shown():
            return window.execute_script("return Array.from(document.querySelectorAll('#leading tbody')).filter((one) => one.checkVisibility())"
                                         ".map((one) => one.querySelector('a').textContent)")
        found = [shown()]
        for kind in ("picks", "gaze", "gaze and picks"):
            menu = window.find_element("css selector", "form.filters select")
            next(option for option in menu.find_elements("tag name", "option") if option.text == kind).click()
            found.append(shown())
        both = ["Schelling points", "Zaragoza"]
        self.assertEqual(found, [both, both[:1], both[1:], both])

    def board(self, name):
        return re.sub(r"<[^>]*>", "", (self.site / f"leaderboards/{name}/index.html").read_text(encoding="utf-8"))

    def test_submissions_are_in_the_folder_of_their_protocol(self):
        self.assertEqual(self.done.returncode, 1)
        self.assertRegex(self.done.stdout, rf"^schelling: refused: bad\.zip: .*\n{re.escape(str(self.site))}/index\.html\n$")
        self.assertTrue((self.site / "leaderboards/schelling/models/G0.html").is_file())
        self.assertIn("There are no submissions yet", self.board("zaragoza"))

    def test_floors_are_marked_on_the_leaderboard(self):
        page = self.board("schelling")
        for model in ("RS", "CB", "NV", "VD", "SD", "MC", "constant"):
            self.assertIn(f"{model} baseline", page)
        self.assertNotIn("HS ceiling", page)
        self.assertNotIn("LS baseline", page)

    def test_a_folder_of_something_else_is_left_alone(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "index.html").write_text("mine")
        done = self.made(other)
        self.assertEqual((done.returncode, done.stderr), (1, f"{other}: holds something else than a site; choose another folder\n"))
        self.assertEqual((other / "index.html").read_text(), "mine")
