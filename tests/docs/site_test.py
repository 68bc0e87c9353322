# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/docs builds the site, its reference has what the program has, and a page needs nothing from elsewhere."""

import re
import subprocess
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import salbench

import pages


class Loads(HTMLParser):
    """Resources that a page loads by itself."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        at = dict(attrs)
        if tag in ("script", "img", "iframe", "source") and at.get("src"):
            self.found.append(at["src"])
        if tag == "link" and at.get("rel") in ("stylesheet", "icon", "preload"):
            self.found.append(at["href"])


@unittest.skipIf(subprocess.run(["/usr/bin/python3", "-c", "import furo, myst_parser, sphinx"], capture_output=True).returncode,
                 "Sphinx is not here: scripts/setup docs")
class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "site"
        cls.done = subprocess.run([pages.ROOT / "scripts/docs", cls.folder], capture_output=True, text=True)

    def page(self, name):
        text = re.sub(r"<[^>]*>", "", (self.folder / f"html/{name}.html").read_text(encoding="utf-8"))
        return text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&").replace("&#39;", "'").replace("&quot;", '"')

    def test_it_builds_without_a_warning(self):
        self.assertEqual((self.done.returncode, self.done.stderr), (0, ""))
        self.assertEqual(self.done.stdout, f"{self.folder}/html/index.html\n")

    def test_the_reference_is_complete(self):
        commands = self.page("reference/commands")
        listed = re.findall(r"^  ([a-z]+) ", subprocess.run([pages.PROGRAM, "--help"], capture_output=True, text=True).stdout
                            .split("Subcommands:")[1].split("\nExamples:")[0], flags=re.M)
        self.assertEqual(len(listed), 13)
        for name in listed:
            for option in re.findall(r"^  (--[a-z-]+)", subprocess.run([pages.PROGRAM, name, "--help"], capture_output=True, text=True).stdout,
                                     flags=re.M):
                self.assertIn(option, commands.split(f"salbench {name} [OPTIONS]")[1].split("[OPTIONS]")[0], name)
        metrics = self.page("reference/metrics")
        self.assertEqual([row.name for row in salbench.metrics.table() if row.help not in metrics], [])
        models = self.page("reference/models")
        self.assertEqual([note for row in salbench.models.table() for _, _, note in row.options if note not in models], [])
        python = self.page("reference/python")
        self.assertEqual([name for name in salbench.__all__ if name[0] != "_" and f"salbench.{name}" not in python], ["metrics", "models"])

    def test_no_page_loads_anything_from_elsewhere(self):
        html = list((self.folder / "html").rglob("*.html"))
        self.assertGreater(len(html), 30)
        for path in html:
            self.assertEqual([name for name in Loads(path.read_text(encoding="utf-8")).found if re.match(r"(\w+:)?//", name)], [], path.name)

    def test_a_broken_link_is_an_error(self):
        source = self.folder / "source"
        (source / "start.md").write_text("# Start\n\n[x](nothing.md#here)\n")
        done = subprocess.run(["/usr/bin/python3", "-B", "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-d", self.folder / "doctrees",
                               source, self.folder / "broken"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing.md", done.stderr)
