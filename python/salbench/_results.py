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

if TYPE_CHECKING:
    import pandas

# What pandas would read as numbers.
NAMES = {"item": str, "view": str, "class": str}


class Maps:
    """The maps of a model by name of the shape: maps["52_3"]."""

    def __init__(self, run: Any, model: str) -> None:
        self._run, self._model = run, model

    def __getitem__(self, item: str) -> NDArray[np.float64]:
        values = self._run.map(self._model, str(item))
        if values is None:
            raise KeyError(f"there is no map of '{item}' by {self._model}")
        return values


class Results:
    """Tables, maps and failures of a run. The tables are those that the program writes into `folder`.

    Attributes
    ----------
    folder : pathlib.Path
        Where the tables lie.
    computed : int
        Artefacts that this run has computed; 0 where all were in the cache.
    failures : list of (item, stage, cause)
        What could not be computed.
    """

    def __init__(self, folder: str, run: Any) -> None:
        self.folder = pathlib.Path(folder)
        self._run = run
        self.computed: int = run.computed
        self.failures: list[tuple[str, str, str]] = run.failures()

    def _table(self, name: str) -> "pandas.DataFrame":
        import pandas

        return pandas.read_csv(self.folder / f"{name}.csv", comment="#", dtype=NAMES, keep_default_na=True)

    @cached_property
    def scores(self) -> "pandas.DataFrame":
        """A row per shape and model (results.csv)."""
        return self._table("results")

    @cached_property
    def summary(self) -> "pandas.DataFrame":
        """Means with their intervals (summary.csv)."""
        return self._table("summary")

    @cached_property
    def ranking(self) -> "pandas.DataFrame":
        """Ranks and groups that cannot be told apart (ranking.csv)."""
        return self._table("ranking")

    @cached_property
    def significance(self) -> "pandas.DataFrame":
        """Every pair of models under every metric (significance.csv)."""
        return self._table("significance")

    def maps(self, model: str) -> Maps:
        """The maps of a model, as it made them."""
        return Maps(self._run, model)

    def report(self, folder: str | os.PathLike[str]) -> pathlib.Path:
        """Writes the report into a folder, and returns its first page."""
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
        return f"Results in {self.folder}: {self.computed} artefacts computed{failed}"
