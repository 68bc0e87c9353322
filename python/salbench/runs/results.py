# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of a run, as tables."""

import datetime
import html
import os
import pathlib
import re
import subprocess
import sys
import warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from salbench import _core
from salbench.runs import failed
from salbench.runs.tables import Tables, read, shown
from salbench.system.console import UNUSABLE_ARGUMENTS, UNUSABLE_STORAGE
from salbench.system.errors import InputError, StorageError
from salbench.system.files import path_of, replace_file, require_file
from salbench.system.names import ByName
from salbench.system.processes import PACKAGES
from salbench.system.progress import say
from salbench.system.types import ArrayLike, NDArray
from salbench.system.yaml import flow_text

if TYPE_CHECKING:
    import pandas

    from salbench.runs.learning import Learner


# The report runs in a separate process, because it forks and configures Matplotlib.
_IN_PROCESS = (
    "import sys; sys.path.insert(0, sys.argv.pop(1)); from salbench.__main__ import main; sys.exit(main())"
)


def _joined(names: str | Sequence[str]) -> str:
    return names if isinstance(names, str) else ",".join(map(str, names))


class Failure(NamedTuple):
    """A failed job: item, stage and cause; for a function that raised, the cause ends with its traceback."""

    item: str
    stage: str
    cause: str


class Reference(ByName[NDArray[np.float64]]):
    """Histograms that maps were matched to, by data set: "meshes", "scans", "clouds". With a single one, it
    can be used as an array: `salbench.score(..., reference=results.reference)`."""

    def __init__(self, histograms: Mapping[str, NDArray[np.float64]]) -> None:
        super().__init__("reference of a data set called", histograms, histograms.__getitem__)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[np.float64]:
        if not self:
            raise ValueError("the run has no reference: none of its shapes has ground truth")
        if len({values.tobytes() for values in self.values()}) > 1:
            raise ValueError(
                f"the run has a reference for each of {', '.join(self)}: choose one, such as "
                f"results.reference['{next(iter(self))}']"
            )
        return np.array(next(iter(self.values())), dtype)


class Results(Tables):
    """Tables of a run, read from its folder; for one returned by `run` also its maps and failures.

    Conclusions from the scores (every table but `scores`) are drawn on first access, and written beside the
    scores.

    Parameters
    ----------
    folder : path
        Argument `out` of `run`, or `--out` of the command `salbench run`.

    Attributes
    ----------
    computed : int
        Number of artefacts that this run computed; 0 if all were in the cache.
    failures : list of (item, stage, cause)
        Failed jobs. The cause of a function that raised ends with its traceback.
    models : dict of str to dict
        By model: "computed" and "read", the number of maps that this run computed and found in the cache, and
        "from", the times of the first and last of the latter (None without any); for trained models also
        "trained" and "failed", the number of folds that this run trained, and whose training failed. Empty
        for tables of a folder.
    """

    def __init__(self, folder: str | os.PathLike[str], run: Any = None) -> None:
        self.folder = pathlib.Path(path_of(folder, "folder"))
        self._concluded = False
        if not any((self.folder / name).is_file() for name in ("run.yaml", "results.csv", "summary.csv")):
            raise FileNotFoundError(
                f"{self.folder}: holds no results (no run.yaml, no results.csv); name the folder that"
                " salbench run wrote (--out)"
            )
        self._run = run
        self._scores: str | None = run.scores if run else None  # digest; None: of the first look
        self._learners: Mapping[str, Learner] = {}  # models trained by `cross_validate`
        self.computed: int = run.computed if run else 0
        self.failures: list[Failure] = [Failure(*row) for row in run.failures()] if run else []
        self.models: dict[str, dict[str, Any]] = {
            name: {
                "computed": computed,
                "read": read,
                "from": tuple(map(datetime.datetime.fromtimestamp, (first, last))) if first <= last else None,
            }
            for name, computed, read, first, last in (run.models() if run else ())
        }

    def _table(self, name: str) -> "pandas.DataFrame":
        from salbench import conclusions

        self._conclude()
        return self._read(name) if (self.folder / f"{name}.csv").exists() else conclusions.empty(name)

    def _read(self, name: str) -> "pandas.DataFrame":
        if self._is_under_way():
            raise InputError(
                f"{self.folder}: a run into it has not ended, and its tables may be of an earlier one: run it again"
            )
        path = self.folder / f"{name}.csv"
        if path.exists():
            require_file(path)
        return read(path)

    def _conclude(self) -> None:
        from salbench import conclusions

        self._require_own()
        if not self._concluded:
            conclusions.conclude_if_missing(self.folder)
            self._concluded = True

    def _require_own(self) -> bytes:
        """Returns the text of run.yaml. Throws InputError if the folder holds the scores of a later run."""
        record = self.folder / "run.yaml"
        text = record.read_bytes() if record.is_file() else b""
        found = re.search(rb"^scores_digest: (\S+)", text, re.MULTILINE)
        now = found[1].decode() if found else ""
        if self._scores is None:
            self._scores = now
        if self._scores != now:
            raise InputError(
                f"{self.folder}: holds a later run by now: give each run a folder of its own by out="
            )
        return text

    def _is_under_way(self) -> bool:
        """True if the last run has not ended, so that tables may be of the one before."""
        return self._require_own().startswith(_core.under_way.encode())

    def _of_folds(self, name: str) -> "pandas.DataFrame":
        from salbench.conclusions import folders

        if not folders.trained_models(self.record) or not (self.folder / f"{name}.csv").is_file():
            raise InputError(f"{self.folder}: has no table {name}, which cross_validate writes")
        return self._read(name)

    @cached_property
    def scores(self) -> "pandas.DataFrame":
        """A row per shape and model (results.csv)."""
        return self._read("results")

    @cached_property
    def costs(self) -> "pandas.DataFrame":
        """Cost of each map when it was computed: seconds and processor seconds, from the cache
        (costs.csv)."""
        return self._read("costs")

    @cached_property
    def folds(self) -> "pandas.DataFrame":
        """For `cross_validate`: a row per fold and item, with its role: scored or trained on (folds.csv)."""
        return self._of_folds("folds")

    @cached_property
    def training(self) -> "pandas.DataFrame":
        """For `cross_validate`: a row per model and fold, with the number of training shapes, its file in
        `keep`, and the seconds of its training, NaN if no call with this folder trained it, or
        another run was made into it afterwards, and `keep` has no file of it (training.csv)."""
        return self._of_folds("training")

    @cached_property
    def record(self) -> dict[str, Any]:
        """Record of the run (run.yaml): versions, the whole configuration, failures; every value as text."""
        from salbench.conclusions import folders

        self._require_own()
        return folders.read_record(self.folder / "run.yaml")

    @cached_property
    def failed(self) -> dict[str, str]:
        """Causes by model, for models without any map; `failures` lists single shapes, too."""
        self._require_own()
        return failed.without_maps(self.folder, self.record)

    @cached_property
    def trained(self) -> dict[str, str]:
        """Training by model, for trained models with maps: such as "cross-validated, 5 folds by class"; made
        by `cross_validate`."""
        from salbench.conclusions import folders

        return {
            model: how
            for model, how in folders.trained_models(self.record).items()
            if model not in self.failed
        }

    @cached_property
    def reference(self) -> Reference:
        """Histograms that maps were matched to, by data set: (100,) arrays (column GS of
        mean_histograms_*.csv)."""
        names = [
            name
            for name in dict.fromkeys(self.scores.dataset)
            if (self.folder / f"mean_histograms_{name}.csv").is_file()
        ]
        tables = {name: self._read(f"mean_histograms_{name}") for name in names}
        return Reference(
            {name: table.GS.to_numpy(np.float64) for name, table in tables.items() if "GS" in table}
        )

    def maps(self, model: str) -> Mapping[str, NDArray[np.float64]]:
        """Maps of a model by shape name, as the model made them: maps("LS")["52_3"].

        For a run by the command, use `Cache`.
        """
        if self._run is None:
            raise ValueError(
                "maps() is of results that run() returned; salbench.Cache(folder) has those of others"
            )

        def read(item: str) -> NDArray[np.float64]:
            values: NDArray[np.float64] = self._run.map(model, os.fsencode(item))
            return values

        self._run.require_model(str(model))
        return ByName(f"map by {model} of an item called", map(os.fsdecode, self._run.mapped(model)), read)

    def score(self, prediction: ArrayLike, item: str, *, model: str | None = None) -> dict[str, float]:
        """Scores a map of a shape like the run does, by the same metrics, ground truth and reference.

        Parameters
        ----------
        prediction : (n,) array
            One finite value per point, or per face if faces are scored. A map of the run, such as
            maps("LS")["52"], gets the scores of its row.
        item : str
            The shape, such as "52", or "52_3" for scan 3 of mesh 52.
        model : str, optional
            Model whose options apply: maps of a model with given maps may be matched already. Default: the
            model that made this map, otherwise the first model.

        Raises
        ------
        KeyError
            An item or a model that is not in the run.
        ValueError
            A map that does not fit the shape, a shape that has no scores, or results of another process.
        """
        if self._run is None:
            raise ValueError(
                "score() is of results that run() returned; salbench.score takes the reference of others"
            )
        scores: dict[str, float] = self._run.score(prediction, os.fsencode(str(item)), str(model or ""))
        return scores

    def write_submission(
        self,
        folder: str | os.PathLike[str],
        model: str,
        *,
        seeds: str | Sequence[str] = (),
        **card: str | Sequence[str],
    ) -> pathlib.Path:
        """Writes a folder for `salbench submit` with the card of a model, and its maps or the means to make
        them (docs/leaderboard.md), and returns its path.

        For a model of `cross_validate` it contains the trained model of each fold, a command that makes the
        maps (predict.py), its packages (requirements.txt) and a configuration for `salbench submit -c`
        (model.yaml), so that others can reproduce the maps. This requires all folds, trained by this call or
        stored by `keep`. Otherwise the folder contains the maps.

        Parameters
        ----------
        folder : path
            Created if missing.
        model : str
            A model of the run.
        seeds : sequence of str
            Further models of the run, which are the same one trained with other seeds: their maps are
            submitted with its own.
        **card : str or sequence of str
            `citation`, `licence` and other keys of the card. For a model of `cross_validate`, the defaults
            are its training for `training_data`, and no overlap with the scored shapes for `test_overlap`.
        """
        from salbench.leaderboard import origin, trained

        to = pathlib.Path(path_of(folder, "folder"))
        maps, seeds = self.maps(model), [seeds] if isinstance(seeds, str) else seeds
        how = self.trained.get(model)
        learned = {"training_data": f"this data set, {how}", "test_overlap": "none"} if how else {}
        declared: dict[str, Any] = {
            "name": model,
            **learned,
            **({"seeds": list(seeds)} if seeds else {}),
            **card,
        }
        to.mkdir(parents=True, exist_ok=True)
        replace_file(
            to / "card.yaml",
            "".join(f"{key}: {flow_text(value)}\n" for key, value in declared.items()).encode(),
        )
        if how:
            try:
                trained.write(
                    to, self._run.protocol, {name: self._learners.get(name) for name in (model, *seeds)}, how
                )
                return to
            except Exception as error:  # also of pickle
                why = " ".join(str(error).split())
                warnings.warn(
                    f"{to}: has the maps of {model} and nothing that makes them: {why}",
                    RuntimeWarning,
                    stacklevel=2,
                )
        for place, of in ((to, maps), *((to / seed, self.maps(seed)) for seed in seeds)):
            place.mkdir(parents=True, exist_ok=True)
            if others := sorted({file.stem for file in place.glob("*.val")} - set(of)):
                raise ValueError(
                    f"{place}: holds {others[0]}.val, and the run has no such map: name an empty folder, or"
                    " remove what another run left"
                )
            for item, values in of.items():
                replace_file(
                    place / f"{item}.val", "".join(f"{float(value)!r}\n" for value in values).encode()
                )
        replace_file(
            to / origin.MADE, origin.made_text(origin.of_model(self.costs, self.record, model), maps).encode()
        )
        return to

    def report(
        self,
        folder: str | os.PathLike[str],
        *,
        mine: str = "",
        metrics: str | Sequence[str] = (),
        models: str | Sequence[str] = (),
        examples: str | Sequence[str] = (),
        exports: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
        viewer: bool = True,
        picks: bool = False,
        processes: int | None = None,
        progress: bool = True,
    ) -> pathlib.Path:
        """Writes the report into a folder, and returns its first page.

        mine: the model that the report is about. metrics, models: on the pages; default: all. examples:
        meshes to show as examples. exports: files of `salbench export`; default: `shapes.h5` in the folder of
        the results, if it exists. viewer: False writes only pictures, neither coordinates nor ground truth.
        picks: as dots on pictures of the ground truth, or fixations without those of people who are left out.
        processes: number that draw; default: one per core.
        progress: a line every ten seconds. Raises ValueError or OSError with the command's message: an
        unknown model, a folder that cannot be written.
        """
        paths = [exports] if isinstance(exports, (str, os.PathLike)) else exports
        arguments = [
            *("--to", os.fspath(folder), "--mine", mine, "--metrics", _joined(metrics)),
            *("--models", _joined(models), "--examples", _joined(examples)),
            *(["--export", *(os.fspath(path) for path in paths)] if paths else []),
            *([] if viewer else ["--no-viewer"]),
            *(["--picks"] if picks else []),
        ]
        self._drawn(arguments, processes, progress)
        return pathlib.Path(folder) / "index.html"

    def figure(
        self,
        folder: str | os.PathLike[str],
        shapes: str | Sequence[str],
        *,
        models: str | Sequence[str] = (),
        metrics: str | Sequence[str] = (),
        views: Mapping[str, tuple[float, float]] | None = None,
        picks: bool = False,
        processes: int | None = None,
        progress: bool = True,
    ) -> pathlib.Path:
        """Writes one figure for print into a folder, figure.pdf and figure.svg, and returns the path of the
        first: one row per shape with its ground truth, maps and scores, at most six to a line.

        shapes: names, such as "52", or "52_3" for a scan. models, metrics: in this order; default: all, and
        the leading ones. views: by mesh or point cloud, azimuth and elevation of the camera in degrees.
        picks, processes, progress, errors: as of `report`.
        """
        words = {
            "shapes": _joined(shapes),
            "models": _joined(models),
            "metrics": _joined(metrics),
            "views": ",".join(f"{name}:{at[0]:g}:{at[1]:g}" for name, at in (views or {}).items()),
        }
        arguments = ["--to", os.fspath(folder), *(["--picks"] if picks else [])]
        arguments += ["--figure", *map("=".join, words.items())]
        self._drawn(arguments, processes, progress)
        return pathlib.Path(folder) / "figure.pdf"

    def _drawn(self, arguments: Sequence[str], processes: int | None, progress: bool) -> None:
        """Runs `salbench report` in a separate process."""
        self._conclude()
        command = [sys.executable, "-B", "-P", "-c", _IN_PROCESS, PACKAGES, "report", str(self.folder)]
        command += [] if processes is None else ["--processes", str(processes)]
        command += [] if progress else ["--quiet"]
        error: list[str] = []
        with subprocess.Popen(
            [*command, *arguments],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
        ) as done:
            for line in done.stderr or ():
                if error or line.startswith("error: "):
                    error.append(line)
                else:
                    say(line.rstrip("\n"))
        if done.returncode:
            of_status = {UNUSABLE_ARGUMENTS: InputError, UNUSABLE_STORAGE: StorageError}
            raise of_status.get(done.returncode, RuntimeError)(
                "".join(error).strip().removeprefix("error: ")
                or f"salbench report: exit status {done.returncode}"
            )

    def _warn_of_failed(self) -> None:
        """Warns in one line about models and folds without any map, with causes."""
        if self.failures and (said := failed.sentence(self.folder, self.record)):
            warnings.warn(said, RuntimeWarning, stacklevel=3)

    def __getstate__(self) -> dict[str, Any]:
        """State for another process, which reads the folder; the run itself, and its maps, belong to this
        process."""
        return {**self.__dict__, "folder": self.folder.absolute(), "_learners": {}}

    def _repr_html_(self) -> str:
        try:
            return shown(self, repr(self))
        except (ImportError, OSError, InputError):  # without pandas; after a run that was interrupted early
            return f"<pre>{html.escape(repr(self))}</pre>"

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return "\n".join(
            [
                f"Results({str(self.folder)!r}): {self.computed} artefacts computed{failed}",
                *(f"  {line}" for line in self._model_lines()),
            ]
        )

    def _model_lines(self) -> list[str]:
        """One line per model on its new maps."""
        lines = []
        for name, maps in self.models.items():
            first, last = (f"{time:%Y-%m-%d %H:%M}" for time in maps["from"]) if maps["from"] else ("", "")
            when = f" (from {first}{'' if first == last else f' to {last}'})" if first else ""
            failed = f"{maps['failed']} failed, " if maps.get("failed") else ""
            trained = f"{maps['trained']} folds trained now, {failed}" if "trained" in maps else ""
            lines.append(f"{name}: {trained}{maps['computed']} maps computed now, {maps['read']} read{when}")
        return lines
