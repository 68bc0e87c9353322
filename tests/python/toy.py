# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the package share: toy meshes, real data where there are some, and runs of the program."""

import os
import pathlib
import random
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(ROOT / "build/release/salbench"))
LEARNABLE = [20 * kind + number for kind in range(5) for number in (1, 2)]  # SHREC'07 has 20 of each class


def meshes(folder, count=3, rings=12, sides=10):
    """A folder of meshes that the program makes up participants for."""
    subprocess.run([ROOT / "scripts/slurm/toy_meshes.py", folder, str(count), str(rings), str(sides)], check=True)
    return pathlib.Path(folder)


def schelling():
    """The meshes and ground truth of the Schelling study; None without them."""
    root = os.environ.get("SALBENCH_DATA")
    return pathlib.Path(root) / "SchellingData" if root else None


def run(config, *options):
    """A run by the command; what it wrote on standard error if it failed."""
    ended = subprocess.run([PROGRAM, "run", config, *map(str, options), "--quiet"], capture_output=True, text=True)
    if ended.returncode:
        sys.exit(f"{PROGRAM} ended with {ended.returncode}: {ended.stderr}")


def export(config, *options):
    subprocess.run([PROGRAM, "export", config, *map(str, options), "--quiet"], check=True)


def learnable(folder):
    """Ten meshes in the Schelling study's form, two of each of five classes and each in a place of its own, whose ground truth is random:
    nothing but memory predicts it."""
    folder = pathlib.Path(folder)
    made = sorted(meshes(folder / "made", 10, 24, 8).glob("*.off"))
    numbers = random.Random(1)
    for part in ("Meshes", "Distributions"):
        (folder / part).mkdir()
    for place, (path, name) in enumerate(zip(made, LEARNABLE)):
        head, counts, *lines = path.read_text().splitlines()
        n = int(counts.split()[0])
        moved = [f"{float(x) + 4 * place} {rest}" for x, rest in (line.split(None, 1) for line in lines[:n])]
        (folder / f"Meshes/{name}.off").write_text("\n".join([head, counts, *moved, *lines[n:]]) + "\n")
        (folder / f"Distributions/{name}.val").write_text("".join(f"{numbers.random()}\n" for _ in range(n)))
    return folder
