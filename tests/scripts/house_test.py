# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of the house in CONTRIBUTING.md, held against the folders."""

import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCREEN = 40  # lines


def map_lines():
    lines = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    first = lines.index("| folder | what is in it |")
    last = next(i for i in range(first, len(lines)) if not lines[i].startswith("|"))
    return lines[:last], lines[first + 2:last]


def folders(path):
    """Folders with files that git knows; in an archive without git, all but those that it would ignore."""
    try:
        listed = subprocess.run(["git", "ls-files", "--", "."], cwd=path, check=True, capture_output=True, text=True).stdout
    except (subprocess.CalledProcessError, FileNotFoundError):
        ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
        return {folder.name for folder in path.iterdir() if folder.is_dir() and f"/{folder.name}/" not in ignored}
    return {line.split("/")[0] for line in listed.splitlines() if "/" in line}


class HouseTest(unittest.TestCase):
    def test_the_map_fits_on_one_screen(self):
        self.assertLessEqual(len(map_lines()[0]), SCREEN)

    def test_the_map_has_every_folder_and_no_other(self):
        named = [name for row in map_lines()[1] for name in re.findall(r"`([\w/*]+)/`", row.split("|")[1])]
        self.assertEqual(len(named), len(set(named)))
        rooms = {name.split("/")[1] for name in named if name.startswith("pipeline/")}
        self.assertEqual(rooms, folders(ROOT / "pipeline"))
        top = {name.split("/")[0] for name in named}
        self.assertEqual(top, {name for name in folders(ROOT) if not name.startswith((".", "build"))})
        for name in named:
            self.assertTrue((ROOT / name.replace("/*", "")).is_dir(), name)

    def test_the_rooms_stand_in_the_order_of_their_includes(self):
        order = re.search(r"^for room in ([\w ]+); do", (ROOT / "tests/layers.sh").read_text(), flags=re.M).group(1).split()
        named = re.findall(r"`pipeline/(\w+)/`", "\n".join(map_lines()[1]))
        self.assertEqual(named, order)


if __name__ == "__main__":
    unittest.main()
