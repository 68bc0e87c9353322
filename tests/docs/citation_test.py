# SPDX-License-Identifier: GPL-3.0-or-later
"""CITATION.cff has what Citation File Format 1.2.0 asks for, with the version, date and licence of the program. GitHub and Zenodo read it."""

import re
import unittest

import yaml

from pages import ROOT


class Citation(unittest.TestCase):
    def setUp(self):
        self.cff = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
        self.version = re.search(r"^project\(salbench VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), flags=re.M)[1]

    def test_keys_that_are_required(self):
        self.assertLessEqual({"cff-version", "message", "title", "authors"}, set(self.cff))
        self.assertEqual((self.cff["cff-version"], self.cff["type"]), ("1.2.0", "software"))
        for author in self.cff["authors"] + [author for work in self.cff["references"] for author in work["authors"]]:
            self.assertTrue("name" in author or {"family-names", "given-names"} <= set(author), author)
        for work in self.cff["references"]:
            self.assertLessEqual({"type", "title", "authors"}, set(work))

    def test_version_date_and_licence(self):
        package = re.search(r'^__version__ = "([\d.]+)"', (ROOT / "python/salbench/_version.py").read_text(), flags=re.M)[1]
        self.assertEqual({self.cff["version"], package}, {self.version})
        self.assertIn(f"\n## [{self.version}] - {self.cff['date-released']}\n", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
        self.assertIn(f'text = "{self.cff["license"]}"', (ROOT / "pyproject.toml").read_text())

    def test_dois_are_those_of_other_places(self):
        readme = (ROOT / "README.md").read_text(encoding="utf-8")
        for work in [self.cff, *self.cff["references"]]:
            if "doi" in work:
                self.assertRegex(work["doi"], r"^10\.\d{4,}/\S+$")
                self.assertIn(f"doi = {{{work['doi']}}}", readme)
