# SPDX-License-Identifier: GPL-3.0-or-later
"""Small data sets, and the program over them."""

import os
import random
import subprocess
from pathlib import Path

from tests.support.shapes import lines

ROOT = Path(__file__).resolve().parents[2]
# Every artefact is synced, and waiting for a disk would be most of the time of tests of whole runs.
MEMORY = "/dev/shm" if os.path.isdir("/dev/shm") else None
PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(ROOT / "build/release/salbench"))


def meshes(folder, count=3, rings=12, sides=10):
    """A folder of tori with bumps, 1.off and so on, each another."""
    subprocess.run([ROOT / "scripts/toy_meshes.py", folder, str(count), str(rings), str(sides)], check=True)
    return Path(folder)


def study(folder, names=(1, 2, 3), rings=16, sides=8, participants=3, without_truth=()):
    """As the Schelling study is: Meshes/, and in Distributions/ and RawData/ random ground truth that is high at few points, and picks that follow it.
    The ground truth by name."""
    folder, numbers, truths = Path(folder), random.Random(1), {}
    made = meshes(folder / "Meshes", len(names), rings, sides)
    for number in range(len(names), 0, -1):
        (made / f"{number}.off").rename(made / f"{names[number - 1]}.off")
    for part in ("Distributions", "RawData"):
        (folder / part).mkdir()
    for name in [name for name in names if name not in without_truth]:
        truth = truths[name] = [numbers.random() ** 4 for _ in range(rings * sides)]
        (folder / f"Distributions/{name}.val").write_text(lines(truth))
        for participant in range(participants):
            (folder / f"RawData/{name}_{participant}.pid").write_text(lines(numbers.choices(range(len(truth)), weights=truth, k=5)))
    return truths


def run(config, *options, subcommand="run"):
    """The program over a configuration, which has to succeed."""
    done = subprocess.run([PROGRAM, subcommand, config, *map(str, options), "--quiet"], capture_output=True, text=True)
    assert done.returncode == 0, f"{subcommand} {options}: {done.returncode}\n{done.stderr}"
