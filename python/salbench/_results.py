# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run has written, as tables."""

import datetime
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
    models : dict of str to dict
        By name of a model: "computed", how many maps this run has computed, "read", how many it found in the cache, and
        "from", when the first and the last of these were stored (None if there are none). Empty for tables of a folder.
    """

    def __init__(self, folder: str | os.PathLike[str], run: Any = None) -> None:
        self.folder = pathlib.Path(folder)
        if not (self.folder / "run.yaml").is_file():
            raise FileNotFoundError(f"{self.folder}: holds no results: no run has written a run.yaml there")
        self._run = run
        self.computed: int = run.computed if run else 0
        self.failures: list[tuple[str, str, str]] = run.failures() if run else []
        self.models: dict[str, dict[str, Any]] = {
            name: {"computed": computed, "read": read,
                   "from": tuple(map(datetime.datetime.fromtimestamp, (first, last))) if first <= last else None}
            for name, computed, read, first, last in (run.models() if run else ())}

    def _text(self, name: str) -> str:
        return (self.folder / f"{name}.csv").read_text(encoding="utf-8")

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
        return "\n".join([f"Results({str(self.folder)!r}): {self.computed} artefacts computed{failed}",
                          *(f"  {line}" for line in self._model_lines())])

    def _model_lines(self) -> list[str]:
        """A line per model: which of its maps are new."""
        lines = []
        for name, maps in self.models.items():
            first, last = (f"{time:%Y-%m-%d %H:%M}" for time in maps["from"]) if maps["from"] else ("", "")
            when = f" (from {first}{'' if first == last else f' to {last}'})" if first else ""
            lines.append(f"{name}: {maps['computed']} maps computed now, {maps['read']} read{when}")
        return lines
