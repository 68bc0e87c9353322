# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are changed at random hang and crash nothing. SALBENCH_FUZZED says how many."""

import os
import subprocess
import sys
import unittest


class Fuzzed(unittest.TestCase):
    def test_each_ends_in_a_shape_or_in_one_line(self):
        count = int(os.environ.get("SALBENCH_FUZZED", "300"))
        ended = subprocess.run([sys.executable, "-B", "fuzzed.py", str(count)], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr[-2000:]), (0, ""))
        self.assertTrue(0.05 * count < int(ended.stdout) < 0.95 * count, f"{ended.stdout} of them were read")
