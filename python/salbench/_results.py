# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run has written, as tables."""

import os
import pathlib
import subprocess
import sys
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from salbench._tables import Tables

if TYPE_CHECKING:
    import pandas


class Maps:
    """The maps of a model by name of the shape: maps["52_3"]."""

    def __init__(self, run: Any, model: str) -> None:
        self._run, self._model = run, model

    def __getitem__(self, item: str) -> NDArray[np.float64]:
        values: NDArray[np.float64] | None = self._run.map(self._model, str(item))
        if values is None:
            raise KeyError(f"there is no map of '{item}' by {self._model}")
        return values


class Results(Tables):
    """Tables of a run, from the folder that it wrote them to; of one that `run` returns also its maps and failures.

    Conclusions from the scores (every table but `scores`) are drawn when the first of them is asked for, and written beside the scores.

    Parameters
    ----------
    folder : path
        What `run` was given as `out`, or the command `salbench run` as `--out`.

    Attributes
    ----------
    computed : int
        Artefacts that this run has computed; 0 where all were in the cache.
    failures : list of (item, stage, cause)
        What could not be computed.
    """

    def __init__(self, folder: str | os.PathLike[str], run: Any = None) -> None:
        self.folder = pathlib.Path(folder)
        if not (self.folder / "run.yaml").is_file():
            raise FileNotFoundError(f"{self.folder}: holds no results: no run has written a run.yaml there")
        self._run = run
        self.computed: int = run.computed if run else 0
        self.failures: list[tuple[str, str, str]] = run.failures() if run else []

    def _text(self, name: str) -> str:
        path = self.folder / f"{name}.csv"
        if not path.is_file():
            self._conclude()
        return path.read_text(encoding="utf-8")

    def _conclude(self) -> None:
        """Draws the conclusions that are missing: a run writes scores alone, and removes conclusions from others."""
        from salbench import conclusions

        if (self.folder / conclusions.folders.CONCLUDED).is_file():
            return
        try:
            conclusions.conclude(conclusions.source_of(str(self.folder)))
        except conclusions.folders.StorageError as error:
            raise OSError(str(error)) from None

    @cached_property
    def scores(self) -> "pandas.DataFrame":
        """A row per shape and model (results.csv)."""
        return self._table("results")

    def maps(self, model: str) -> Maps:
        """The maps of a model by name of the shape, as it made them: maps("LS")["52_3"].

        Of a run that was made by a command, `Cache` has them.
        """
        if self._run is None:
            raise ValueError("maps() is of results that run() returned; salbench.Cache(folder) has those of others")
        return Maps(self._run, model)

    def report(self, folder: str | os.PathLike[str]) -> pathlib.Path:
        """Writes the report into a folder, and returns its first page."""
        self._conclude()
        roots = [pathlib.Path(__file__).parent, pathlib.Path("/usr/share/salbench")]
        root = next((root for root in roots if (root / "report").is_dir()), None)
        if root is None:
            raise FileNotFoundError(f"the report is neither in {roots[0]} nor in {roots[1]}: install salbench")
        environment = os.environ | {"PYTHONPATH": str(root)}
        subprocess.run([sys.executable, "-B", "-P", "-m", "report", str(self.folder), "--to", os.fspath(folder)],
                       env=environment, check=True)
        return pathlib.Path(folder) / "index.html"

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"Results({str(self.folder)!r}): {self.computed} artefacts computed{failed}"
