# SPDX-License-Identifier: GPL-3.0-or-later
"""Dry run: the artefacts that a run would compute."""

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from salbench import _core, datasets
from salbench.models.function import Model, Predict
from salbench.runs.settings import Settings, settings_of
from salbench.system.console import SCHEMA
from salbench.system.types import ArrayLike

if TYPE_CHECKING:
    import pandas


class Plan(dict[str, Any]):
    """The document of `salbench plan --format json` (docs/json.md), as a dict: "open" is the number of
    artefacts that a run would compute or check again, "stages" a list with a dict for each stage.

    Attributes
    ----------
    folds : dict of list of int
        By model, the folds that `cross_validate` would train, from 0.
    """

    def __init__(self, document: Mapping[str, Any], folds: Mapping[str, Sequence[int]] | None = None) -> None:
        super().__init__(document)
        self.folds = {name: list(of_model) for name, of_model in (folds or {}).items()}

    @property
    def to_compute(self) -> dict[str, int]:
        """Number of artefacts to compute by stage, including those that wait for inputs; stages without any
        are left out."""
        counts = {row["stage"]: row["to_compute"] + row["waiting"] for row in self["stages"]}
        return {stage: count for stage, count in counts.items() if count}

    @property
    def why(self) -> dict[str, dict[str, int]]:
        """By stage, the reasons with the number of artefacts for each."""
        return {
            row["stage"]: {reason["why"]: reason["jobs"] for reason in row["reasons"]}
            for row in self["stages"]
            if row["reasons"]
        }

    def frame(self) -> "pandas.DataFrame":
        """A row per stage."""
        import pandas

        why = [
            "; ".join(f"{reason['why']}: {reason['jobs']}" for reason in row["reasons"])
            for row in self["stages"]
        ]
        return pandas.DataFrame(self["stages"]).drop(columns="reasons").assign(why=why)

    def __repr__(self) -> str:
        lines = [
            f"{count} {stage}" + (f": {', '.join(self.why[stage])}" if stage in self.why else "")
            for stage, count in self.to_compute.items()
        ]
        lines += [
            f"{name}: folds to be trained: {', '.join(map(str, folds)) or 'none'}"
            for name, folds in self.folds.items()
        ]
        return "\n".join([f"{self['open']} artefacts to compute", *lines])


def plan(
    config: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    data: str | os.PathLike[str] | datasets.Dataset | None = None,
    models: Mapping[str, Predict | Model | Mapping[str, Any] | None] | None = None,
    cache: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    items: str | Iterable[str] | None = None,
    split: str | None = None,
    reference: str | os.PathLike[str] | ArrayLike | None = None,
    threads: int | None = None,
    progress: bool = True,
    keep_going: bool = False,
) -> Plan:
    """Returns what `run` would compute with these arguments, and why. Computes and writes nothing, and calls
    none of your functions.

    Parameters
    ----------
    config, data, models, cache, out, items, split, reference
        As of `run`.
    threads, progress, keep_going
        As of `run`; they change no plan.

    Returns
    -------
    Plan
        A dict.

    Raises
    ------
    KeyError, ValueError, OSError
        As of `run`.

    Examples
    --------
    >>> import pathlib, salbench, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> _ = (folder / "box.off").write_text("OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 2 1\\n3 0 1 3\\n3 0 3 2\\n3 1 2 3\\n")
    >>> def height(shape):
    ...     return shape.points[:, 2]
    >>> made = salbench.plan({"dataset": {"participants": "simulated", "scans": False}}, data=folder, models={"HEIGHT": height},
    ...                      cache=folder / "cache", out=folder / "out")
    >>> made.to_compute["map.HEIGHT"], made.why["map.HEIGHT"]
    (1, {'waits for mesh': 1})
    """
    _core.thread_count(threads, "threads")  # refuses what a run refuses
    return planned(settings_of(config, data, models, cache, out, items, split, reference))[0]


def planned(settings: Settings) -> tuple[Plan, dict[str, list[str]]]:
    """Returns the plan, and the shapes whose maps would be computed, by function."""
    found = _core.Planned(settings, settings.own_models)
    document = {"schema": SCHEMA, "command": "plan", "stages": found.rows(), **found.summary()}
    return Plan(document), {
        name: [os.fsdecode(item) for item in found.open(name)] for name in settings.functions
    }
