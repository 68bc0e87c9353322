# SPDX-License-Identifier: GPL-3.0-or-later
"""CITATION.cff and .zenodo.json have what Citation File Format 1.2.0 and Zenodo ask for, and one version and date."""

import datetime
import json
import re
import unittest

import yaml

from pages import ROOT


class Citation(unittest.TestCase):
    def setUp(self):
        self.cff = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
        self.zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
        self.version = re.search(r"^project\(salbench VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), flags=re.M)[1]

    def test_keys_that_are_required(self):
        self.assertLessEqual({"cff-version", "message", "title", "authors"}, set(self.cff))
        self.assertEqual(self.cff["cff-version"], "1.2.0")
        for author in self.cff["authors"] + [author for work in self.cff["references"] for author in work["authors"]]:
            self.assertTrue("name" in author or {"family-names", "given-names"} <= set(author), author)
        for work in self.cff["references"]:
            self.assertLessEqual({"type", "title", "authors"}, set(work))
        self.assertLessEqual({"title", "upload_type", "description", "creators", "access_right", "license"}, set(self.zenodo))
        self.assertEqual((self.zenodo["upload_type"], self.zenodo["access_right"]), ("software", "open"))
        self.assertTrue(all(creator["name"] for creator in self.zenodo["creators"]))

    def test_one_version_date_and_licence(self):
        package = re.search(r'^__version__ = "([\d.]+)"', (ROOT / "python/salbench/_version.py").read_text(), flags=re.M)[1]
        self.assertEqual({self.cff["version"], self.zenodo["version"], package}, {self.version})
        self.assertEqual(self.cff["date-released"], self.zenodo["publication_date"])
        datetime.date.fromisoformat(self.zenodo["publication_date"])
        self.assertIn(f"\n## [{self.version}] - {self.cff['date-released']}\n", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
        self.assertEqual(self.cff["license"], self.zenodo["license"])

    def test_the_same_people_and_words(self):
        self.assertEqual([author["name"] for author in self.cff["authors"]], [creator["name"] for creator in self.zenodo["creators"]])
        self.assertEqual(self.cff["keywords"], self.zenodo["keywords"])
