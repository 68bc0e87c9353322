# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a report stands in: what an earlier call wrote there goes, everything else is left alone."""

import shutil
from pathlib import PurePosixPath

from report.results import Unusable

MARK = "salbench report"  # <meta name="generator"> of every page: a folder whose index.html has it may be written again
FOLDERS = ("figures", "data", "shapes", "pictures", "static")
LIST = "files.txt"  # of the files of the report, one per line


class Folder:
    """Empties the folder of a report, or makes one. Unusable if it holds something else than a report."""

    def __init__(self, path):
        self.path = path
        self.names = set()
        try:
            if path.exists() and not path.is_dir():
                raise Unusable(f"{path}: not a folder; choose another with --to")
            if path.is_dir() and any(path.iterdir()):
                if not is_ours(path / "index.html"):
                    raise Unusable(f"{path}: holds something else than a report; choose another folder with --to")
                remove_report(path)
            for folder in FOLDERS:
                (path / folder).mkdir(parents=True, exist_ok=True)
            (path / LIST).write_text("")
            self.file("index.html").write_text(f'<meta name="generator" content="{MARK}"><title>Unfinished</title>')
        except OSError as error:
            raise Unusable(f"{path}: cannot be written: {error.strerror}; choose another folder with --to") from None

    def file(self, name):
        """The path of a file of the report, "data/means.csv", to be written now. It is on the list before it is there, so that
        the next call knows what a call that was ended left behind."""
        if name not in self.names:
            self.names.add(name)
            with open(self.path / LIST, "a", encoding="utf-8") as names:
                print(name, file=names)
        path = self.path / name
        path.parent.mkdir(exist_ok=True)
        return path


def is_ours(page):
    try:
        return MARK in page.read_text(encoding="utf-8", errors="replace")[:600]
    except FileNotFoundError:
        return False


def remove_report(path):
    """Removes the files on the list, but for index.html, and the folders that are then empty."""
    if not (path / LIST).is_file():  # an older version wrote the report: all of these folders was its own
        for folder in FOLDERS:
            shutil.rmtree(path / folder, ignore_errors=True)
        for page in path.glob("*.html"):
            if page.name != "index.html" and is_ours(page):
                page.unlink()
        return
    names = (path / LIST).read_text(encoding="utf-8", errors="replace").splitlines()
    for name in map(PurePosixPath, names):
        within = not name.is_absolute() and ".." not in name.parts
        if within and (path / name).is_file() and name.name != "index.html":
            (path / name).unlink()
    for folder in sorted((entry for name in FOLDERS for entry in (path / name).glob("**/")), reverse=True):
        if not any(folder.iterdir()):
            folder.rmdir()
