# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of docs/leaderboard.md, one after the other, over three toy meshes in the Schelling study's form."""

import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ["SALBENCH_PROGRAM"])


def toy(folder):
    """SchellingData, and maps in mine/."""
    subprocess.run([ROOT / "scripts/slurm/toy_meshes.py", folder / "toy", "3", "16", "8"], check=True)
    numbers = random.Random(1)
    for part in ("SchellingData/Meshes", "SchellingData/Distributions", "SchellingData/RawData", "mine", "bin"):
        (folder / part).mkdir(parents=True)
    for mesh in sorted((folder / "toy").glob("*.off")):
        text = mesh.read_text()
        n = int(text.split()[1])
        (folder / "SchellingData/Meshes" / mesh.name).write_text(text)
        for place in ("SchellingData/Distributions", "mine"):
            (folder / place / f"{mesh.stem}.val").write_text("".join(f"{numbers.random()}\n" for _ in range(n)))
        for participant in range(2):
            picks = "".join(f"{pick}\n" for pick in numbers.sample(range(n), 5))
            (folder / f"SchellingData/RawData/{mesh.stem}_{participant}.pid").write_text(picks)
    (folder / "bin/salbench").symlink_to(PROGRAM)


class LeaderboardDocs(unittest.TestCase):
    def test_the_blocks_of_the_page(self):
        page = (ROOT / "docs/leaderboard.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```(yaml|sh)\n(.*?)^```$", page, flags=re.M | re.S)
        self.assertEqual([kind for kind, _ in blocks], ["yaml", "sh", "sh"])
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            toy(folder)
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
            for kind, text in blocks:
                if kind == "yaml":
                    (folder / re.match(r"# (\S+)\n", text)[1]).write_text(text)
                    continue
                done = subprocess.run(["/bin/sh", "-ec", text], cwd=folder, env=environment, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
            index = (folder / "site/index.html").read_text()
            self.assertIn('<a href="models/MINE.html">MINE</a>', index)
            self.assertIn("ShapeNet", (folder / "site/models/MINE.html").read_text())
            documented = set(re.findall(r"^\| `(\w+\.\w+)` \|", page.split("table in `site/data`")[1], flags=re.M))
            self.assertLessEqual(documented, {path.name for path in (folder / "site/data").iterdir()})


if __name__ == "__main__":
    unittest.main()
