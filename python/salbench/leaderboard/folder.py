# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a site. A site is made elsewhere and put there file by file, each whole or not at all; who was ended on the way leaves what the
next call brings to an end."""

from pathlib import Path

from salbench._errors import InputError
from salbench._files import OwnFolder
from salbench.conclusions import TABLES
from salbench.leaderboard.board import OF_THE_RUN
from salbench.pages.rendering import OF_LEADERBOARD, is_ours

OURS = OF_LEADERBOARD  # written first
FOLDERS = ("data", "models", "static")
_UNFINISHED = ".unfinished"
_OLDER = ("run.yaml", "conclusions.json", "means.csv", "overlap.csv", "seeds.csv", "history.csv", "left.csv", "feed.json")  # and of other runs


def require_own(site: Path) -> None:
    """Throws InputError for a folder that holds something else, or leads elsewhere."""
    for folder in (site, *(site / name for name in FOLDERS)):
        if folder.is_symlink():
            raise InputError(f"{folder}: is a link; name the folder itself with --to")
        if folder.exists() and not folder.is_dir():
            raise InputError(f"{folder}: not a folder; choose another with --to")
    if site.is_dir() and not (site / OURS).is_file():
        found = [path for path in site.rglob("*") if not path.name.endswith(_UNFINISHED) and path not in [site / name for name in FOLDERS]]
        if found:
            raise InputError(f"{site}: holds something else than a leaderboard; choose another with --to")


def publish(made: Path, site: Path) -> None:
    """Brings the site to what was made: files that are the same stay untouched, index.html is written last, then stale files go."""
    with OwnFolder(site, "choose another folder with --to", below=FOLDERS, follow=False) as own:
        require_own(site)
        files = sorted(str(path.relative_to(made)) for path in made.rglob("*") if path.is_file())
        for name in sorted(files, key=lambda name: (name != OURS, name == "index.html", name)):
            data = (made / name).read_bytes()
            if own.read(name, len(data)) != data:
                own.write(name, data)
        for path in [*site.glob("*"), *(path for name in FOLDERS for path in (site / name).glob("*"))]:
            name = str(path.relative_to(site))
            if name not in files and _is_stale(path, own.head(name)):
                own.remove(name)


def _is_stale(path: Path, head: bytes) -> bool:
    """True for what an earlier call wrote, or one of version 1.0 was ended in. head: its first bytes, if it is a file."""
    if path.name.endswith(_UNFINISHED):
        return True
    if path.parent.name == "data":
        return path.name in (*_OLDER, *OF_THE_RUN, *(f"{table.name}.csv" for table in TABLES)) or path.name.startswith("mean_histograms_")
    return path.suffix == ".html" and is_ours(head)
