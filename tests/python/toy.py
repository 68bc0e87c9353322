# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the package share: toy meshes, real data where there are some, and runs of the program."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SALBENCH_PROGRAM", str(ROOT / "build/release/salbench"))


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
