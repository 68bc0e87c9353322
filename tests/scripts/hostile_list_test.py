# SPDX-License-Identifier: GPL-3.0-or-later
"""tests/hostile.csv: what strangers may send or do, and the test that holds each. Every test is there, with the row of its table."""

import csv
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("submissions", "one form", "Python", "commands", "report", "cache")


class HostileList(unittest.TestCase):
    def test_each_line_names_a_test_that_there_is(self):
        with open(ROOT / "tests/hostile.csv", newline="") as file:
            lines = [*csv.reader(file)][1:]
        self.assertEqual([*dict.fromkeys(line[0] for line in lines)], [*PARTS])
        self.assertEqual(len({(part, what) for part, what, *_ in lines}), len(lines), "twice")
        for part, what, file, test, row in lines:
            with self.subTest(part, what=what):
                text = (ROOT / file).read_text()
                suite, _, name = test.rpartition(".")
                self.assertTrue(re.search(rf"\({suite},\s+{name}\)" if suite else rf"def {re.escape(test)}\(" if test else "def test_", text), f"{file}: {test}")
                self.assertTrue(row in text, f"{file}: {row}")
