# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a site. A site is written elsewhere and moved here when complete."""

import os
from pathlib import Path

from salbench.conclusions import TABLES
from salbench.leaderboard.board import OF_THE_RUN
from salbench.pages.rendering import OF_LEADERBOARD, is_ours
from salbench.system.errors import InputError
from salbench.system.files import FolderUpdate, has_unfinished, holds

FOLDERS = ("data", "models", "static")
# including those of other runs
_OLDER = (
    "run.yaml",
    "conclusions.json",
    "means.csv",
    "overlap.csv",
    "seeds.csv",
    "history.csv",
    "left.csv",
    "feed.json",
)


def require_own(site: Path) -> None:
    """Throws InputError for a folder that holds something else."""
    if site.exists() and not site.is_dir():
        raise InputError(f"{site}: not a folder; choose another with --to")
    if (
        site.is_dir()
        and os.listdir(site)
        and not has_unfinished(site)
        and not (site / OF_LEADERBOARD).is_file()
    ):
        raise InputError(f"{site}: holds something else than a leaderboard; choose another with --to")


def publish(made: Path, site: Path) -> None:
    """Updates the site: unchanged files stay untouched, index.html is written last, then stale files are
    removed."""
    require_own(site)
    with FolderUpdate(site, "choose another folder with --to") as update:
        files = {str(path.relative_to(made)): path.read_bytes() for path in made.rglob("*") if path.is_file()}
        for name, data in files.items():
            if not holds(site / name, data):
                update.write(name, data)
        update.finish(last="index.html")
        for path in [*site.glob("*"), *(path for name in FOLDERS for path in (site / name).glob("*"))]:
            name = str(path.relative_to(site))
            if name not in files and _is_stale(path):
                update.remove(name)


def _is_stale(path: Path) -> bool:
    """True for files that an earlier call wrote."""
    if path.parent.name == "data":
        return path.name in (
            *_OLDER,
            *OF_THE_RUN,
            *(f"{table.name}.csv" for table in TABLES),
        ) or path.name.startswith("mean_histograms_")
    return path.suffix == ".html" and is_ours(path)
