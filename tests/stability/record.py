#!/usr/bin/python3 -B
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the old examples anew that are text, with what has come in addition since: before a version. Tests must pass before. The cache of
computed.tar.xz stays: it is the one that 1.1 left.

PYTHONPATH=build/release/python tests/stability/record.py
"""

import shutil
import sys
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


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(support.EXAMPLES, folder, dirs_exist_ok=True)
        for line in support.RUNS:
            said(folder, line + " --quiet")
        said(folder, support.EXPORT + " --to export.h5")
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
