# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything named on the pages exists, and their lists are complete."""

import csv
import fnmatch
import os
import re
import subprocess
import tempfile
import unittest
import urllib.parse
from pathlib import Path

import salbench
import yaml
from salbench._core import models_about
from salbench.datasets.sets import LAYOUTS
from salbench.report import elements

import pages

README = (pages.ROOT / "README.md").read_text(encoding="utf-8")
DATA = os.environ.get("SALBENCH_DATA", "")


def documented_metrics():
    """Name -> better, of the tables of docs/metrics.md: "`cc`, `lcc`" are two names."""
    rows = {}
    for line in (pages.ROOT / "docs/metrics.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) == 5 and cells[3] in ("higher", "lower"):
            rows.update(dict.fromkeys(re.findall(r"`([^`]+)`", cells[0]), cells[3]))
    return rows


class Pages(unittest.TestCase):
    def test_every_metric_has_its_row_with_its_direction(self):
        rows = documented_metrics()
        table = salbench.metrics.table()
        self.assertEqual(rows, {row.name: "higher" if row.higher_is_better else "lower" for row in table})

    def test_every_model_has_its_words(self):
        """Models of the paper also have a section."""
        for row in salbench.models.table():
            self.assertTrue(models_about[row.name].name, row.name)
        text = (pages.ROOT / "docs/methods.md").read_text(encoding="utf-8")
        for name in ("LS", "CS", "PS", "MS", "HS", "RS"):
            self.assertRegex(text, rf"(?m)^### .*\b{name}\b")

    def test_every_data_set_and_what_reads_them_has_its_row(self):
        text = (pages.ROOT / "docs/data_sets.md").read_text(encoding="utf-8")
        named = {name for row in re.findall(r"(?m)^\| (`[^|]+) \|", text) for name in re.findall(r"`(\w+)", row)}
        self.assertEqual(sorted({*LAYOUTS} - named), ["automatic"])
        self.assertEqual(sorted({*salbench.datasets.__all__} - {*re.findall(r"`(\w+)", text)}), [])

    def test_what_is_cited_is_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", (pages.ROOT / "docs/bibliography.bib").read_text(encoding="utf-8"), flags=re.M))
        self.assertLessEqual({about.key for about in models_about.values()} - {""}, keys)
        for path in [*pages.PAGES, *(pages.ROOT / "python/salbench/datasets").glob("*.py")]:
            self.assertEqual(set(re.findall(r"\[([a-z]+\d{4}\w*)\]", path.read_text(encoding="utf-8"))) - keys, set(), path.name)

    def test_every_element_of_the_report_says_how_to_read_it(self):
        text = (pages.ROOT / "docs/results.md").read_text(encoding="utf-8")
        self.assertEqual([element.title for element in elements.ELEMENTS if f"| {element.title} |" not in text], [])

    def test_every_file_of_a_run_has_its_row(self):
        text = (pages.ROOT / "docs/results.md").read_text(encoding="utf-8")
        named = [name for row in re.findall(r"(?m)^\| (`[^|]+) \|", text) for name in re.findall(r"`([\w.*]+)`", row)]
        with tempfile.TemporaryDirectory() as name:
            here = Path(name)
            subprocess.run([pages.PROGRAM, "run", "configs/shrec07_meshes.yaml", "--data", "SchellingData", "--out", "out", "--quiet"],
                           cwd=here, env=pages.workspace(here), check=True, stderr=subprocess.PIPE)
            left = sorted(path.name for path in (here / "out").iterdir())
            record = yaml.safe_load((here / "out/run.yaml").read_text(encoding="utf-8"))
        self.assertIn("results.csv", left)
        self.assertEqual([file for file in left if not any(fnmatch.fnmatch(file, pattern) for pattern in named)], [])
        with open(pages.ROOT / "docs/tables/columns.csv", encoding="utf-8", newline="") as file:
            keys = {row["name"].partition(":")[0] for row in csv.DictReader(file) if row["file"] == "run.yaml"}
        self.assertEqual([key for key in record if key not in keys], [])

    def test_files_named_exist(self):
        """Checks files of the tree, such as `docs/metrics.md`, except names with placeholders, and the example model XS of one page."""
        tops = "cache|cmake|configs|docs|io|models|pipeline|python|scripts|stages|tests"
        for page in pages.PAGES:
            for name in re.findall(rf"`((?:{tops})/[\w./-]*)`", pages.prose(page)):
                if not re.search(r"NAME|/xs", name):
                    self.assertTrue((pages.ROOT / name).exists(), f"{page.name}: {name}")

    def test_functions_named_beside_their_file_exist(self):
        """Such as `plan.cpp: decide()`, in the text and in blocks, on decision pages too."""
        tops = ("cache", "io", "pipeline", "python", "scripts", "stages", "tests")
        files = [path for top in tops for path in (pages.ROOT / top).rglob("*.*")]
        named = [(page.name, *name) for page in [*pages.PAGES, *(pages.ROOT / "docs/decisions").glob("*.md")]
                 for name in re.findall(r"([\w/]+\.(?:cpp|h|py))`?: `?(\w+)\(\)", page.read_text(encoding="utf-8"))]
        self.assertGreater(len(named), 3)
        for page, file, name in named:
            texts = [path.read_text(encoding="utf-8") for path in files if str(path).endswith(f"/{file}")]
            found = any(re.search(rf"\b{name}\(", text) for text in texts)
            self.assertTrue(found, f"{page}: {file}: {name}()")

    def test_links_of_the_files_beside_the_site(self):
        """Checks links outside docs/, which scripts/docs does not: files from the root, and the syntax of addresses."""
        for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
            for target in re.findall(r"\]\(([^)\s]+)\)", pages.prose(pages.ROOT / name)):
                if "://" not in target:
                    path, _, anchor = target.partition("#")
                    self.assertTrue((pages.ROOT / path).exists(), f"{name}: {target}")
                    if anchor:
                        heads = re.findall(r"^#+ (.*)$", (pages.ROOT / path).read_text(encoding="utf-8"), flags=re.M)
                        self.assertIn(anchor, [re.sub(r"[^\w -]", "", head).lower().replace(" ", "-") for head in heads], f"{name}: {target}")
        for page in [*pages.PAGES, pages.ROOT / "CHANGELOG.md"]:
            for address in re.findall(r"https?://[^\s)>`\"]+", page.read_text(encoding="utf-8")):
                parts = urllib.parse.urlsplit(address)
                self.assertRegex(parts.hostname or "", r"^[\w-]+(\.[\w-]+)+$", f"{page.name}: {address}")


class Readme(unittest.TestCase):
    """Short, with one picture, and a table that its command prints."""

    def test_length_and_picture(self):
        self.assertLessEqual(len(README.splitlines()), 120)
        pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
        self.assertEqual(len(pictures), 1)

    def test_a_model_takes_ten_lines(self):
        self.assertLessEqual(len(next(block for block in pages.blocks(pages.ROOT / "README.md") if block.language == "python").text.splitlines()), 10)

    @unittest.skipUnless(DATA and os.path.isdir(f"{DATA}/reference"), "the real data is not here: set SALBENCH_DATA")
    def test_the_table_is_what_its_command_prints(self):
        done = subprocess.run([pages.ROOT / "scripts/figures", "readme", DATA], capture_output=True, text=True, check=True)
        self.assertEqual(len(done.stdout.splitlines()), 7)
        self.assertIn("\n" + done.stdout, README)
