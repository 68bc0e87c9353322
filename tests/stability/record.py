#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the old examples anew that the program makes itself, with what has come in addition since: before a version 1.x, and after the
version of a stage was raised. Tests must pass before, but for those of what was changed on purpose.

PYTHONPATH=build/release/python tests/stability/record.py
"""

import lzma
import shutil
import sys
import tarfile
import tempfile
from pathlib import Path

import commands_test
import python_test
import support


def said(folder, line):
    done = support.salbench(folder, line)
    if done.returncode:
        sys.exit(f"salbench {line}: {done.stderr}")
    return done.stdout


def without_owner(member):
    member.mtime = member.uid = member.gid = 0
    member.uname = member.gname = ""
    return member


def compute(folder):
    """Packs what runs over the examples in a folder leave in its cache, and an export of it."""
    for line in support.RUNS:
        said(folder, line + " --quiet")
    said(folder, support.EXPORT + " --to export.h5")
    with tarfile.open(folder / support.COMPUTED, "w:xz", preset=9 | lzma.PRESET_EXTREME) as computed:
        for path in (*sorted((folder / "cache").iterdir()), folder / "export.h5"):
            computed.add(path, path.relative_to(folder), filter=without_owner)


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(support.EXAMPLES, folder, dirs_exist_ok=True)
        compute(folder)
        shutil.copy(folder / support.COMPUTED, support.EXAMPLES)
        configuration = said(folder, "config meshes.yaml")
        for line in commands_test.LINES:
            said(folder, line)
        tables = {(path.rpartition("/")[2], tuple(names)) for path, names in commands_test.tables(folder).items()}
    columns = "".join(f"{name}: {','.join(names)}\n" for name, names in sorted(tables))
    python = "".join(f"{line}\n" for line in python_test.lines())
    for name, text in (("complete.yaml", configuration), ("columns.txt", columns), ("python.txt", python)):
        (support.EXAMPLES / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
