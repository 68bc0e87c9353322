# SPDX-License-Identifier: GPL-3.0-or-later
"""`salbench` as pip installs it: becomes the program in this package, whose Python is this one."""

import os
import sys
from pathlib import Path


def main() -> None:
    os.environ.setdefault("SALBENCH_PYTHON", sys.executable)
    os.execv(Path(__file__).with_name("bin") / "salbench", ["salbench", *sys.argv[1:]])
