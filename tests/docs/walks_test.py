# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files a change touches (CONTRIBUTING.md), and which files a mesh, a function, a data set and a page pass (how_it_works.md): lists that
have what the tree says of an example, and no file that is not there."""

import os
import re
import unittest

import pages

CODE = ("cache", "configs", "docs", "io", "pipeline", "python", "stages")
ASIDE = {"docs/bibliography.bib"}


def rows():
    """Example -> files, of the table of what to touch."""
    text = (pages.ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    found = re.findall(r"^\| (\w+ [\w ]+) \| `(\w+)` \| (.*) \|$", text, flags=re.M)
    return {(what, example): set(re.findall(r"`([\w./]+\.\w+|[\w./]+/)`", files)) for what, example, files in found}


def naming(word):
    """Files of the tree, but for tests, that have a word or are named so."""
    for top in CODE:
        for path in (pages.ROOT / top).rglob("*"):
            if path.suffix in (".cpp", ".h", ".py", ".yaml", ".md", ".csv") and "__pycache__" not in path.parts:
                if path.stem.lower() == word.lower() or re.search(rf"\b{word}\b", path.read_text(encoding="utf-8")):
                    yield str(path.relative_to(pages.ROOT))


class Walks(unittest.TestCase):
    def test_there_is_one_for_each_kind_of_change(self):
        self.assertEqual([what for what, _ in rows()],
                         ["change a model", "add a metric", "add a model", "add a data set", "add a page", "publish a model"])

    def test_what_a_row_names_is_there(self):
        for (what, _), files in rows().items():
            self.assertTrue(files, what)
            named = {name for name in files if "/" in name.rstrip("/") or name.endswith(".md")}
            self.assertEqual([name for name in sorted(named) if not (pages.ROOT / name).exists()], [], what)

    def test_what_names_an_example_stands_in_its_row(self):
        for (what, example), files in rows().items():
            if what.startswith("add"):
                touched = {name for name in naming(example)} - ASIDE
                left = {name for name in touched - files if not name.endswith(f"{example.lower()}.cpp")}
                self.assertEqual(left, set(), what)
                self.assertGreater(len(touched), 1, what)

    def test_files_that_an_example_passes_are_there(self):
        text = (pages.ROOT / "docs/how_it_works.md").read_text(encoding="utf-8")
        found = [block for block in re.findall(r"```text\n(.*?)```", text, flags=re.S) if block.startswith("python/salbench  ")]
        self.assertEqual(len(found), 4)
        for block in found:
            place = ""
            for line in block.splitlines():
                place, files = line[:20].strip() or place, re.split(r" {2,}", line[20:])[0]
                folder = ""
                for name in files.split(", "):
                    folder, name = (os.path.dirname(name), name) if "/" in name else (folder, os.path.join(folder, name))
                    self.assertTrue((pages.ROOT / place / name).exists(), line)
