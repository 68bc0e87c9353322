# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/stability.md names tests that exist, one at least for each interface."""

import re
import subprocess
import unittest
from pathlib import Path

import support

PAGE = (support.EXAMPLES.parents[2] / "docs/stability.md").read_text(encoding="utf-8")


def promises():
    """Names of tests by interface: the last cell of each row of its table, and the first."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if line.startswith("| ")]
    return {row[0]: re.findall(r"`([^`]+)`", row[-1]) for row in rows[1:]}


class Page(unittest.TestCase):
    def test_each_interface_has_tests_and_these_exist(self):
        listed = subprocess.run(["ctest", "-N", "--test-dir", Path(support.PROGRAM).parent], capture_output=True, text=True, check=True).stdout
        known = set(re.findall(r"^ *Test +#\d+: (\S+)", listed, flags=re.M))
        self.assertEqual(len(promises()), 9)
        for interface, tests in promises().items():
            self.assertTrue(tests, interface)
            self.assertEqual([name for name in tests if name not in known], [], interface)

    def test_each_test_of_old_examples_is_named(self):
        named = {name for tests in promises().values() for name in tests}
        here = {f"stability.{path.stem}" for path in Path(__file__).parent.glob("*_test.py")} - {"stability.page_test"}
        self.assertEqual(here - named, set())
