# SPDX-License-Identifier: GPL-3.0-or-later
"""README.md: short, with one picture, and a table that its command prints."""

import os
import re
import subprocess
import unittest

import pages

TEXT = (pages.ROOT / "README.md").read_text(encoding="utf-8")
DATA = os.environ.get("SALBENCH_DATA", "")


class Readme(unittest.TestCase):
    def test_length_and_picture(self):
        self.assertLessEqual(len(TEXT.splitlines()), 120)
        pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", TEXT)
        self.assertEqual(len(pictures), 1)

    def test_a_model_takes_ten_lines(self):
        self.assertLessEqual(len(next(block for block in pages.blocks(pages.ROOT / "README.md") if block.language == "python").text.splitlines()), 10)

    @unittest.skipUnless(DATA and os.path.isdir(f"{DATA}/reference"), "the real data is not here: set SALBENCH_DATA")
    def test_the_table_is_what_its_command_prints(self):
        done = subprocess.run([pages.ROOT / "scripts/figures", "readme", DATA], capture_output=True, text=True, check=True)
        self.assertEqual(len(done.stdout.splitlines()), 9)
        self.assertIn("\n" + done.stdout, TEXT)


if __name__ == "__main__":
    unittest.main()
