# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that learn: the map of each shape comes from a model that was trained without it, its views and, by class, its class.

A plan says which fold a shape is in and what that fold is trained on. A learner is a model of a run whose function trains a fold when
the first of its maps is missing in the cache. The key of a map has what its fold was trained on, so maps of other folds stay.
"""

import csv
import dataclasses
import hashlib
import inspect
import io
import logging
import numbers
import os
import pathlib
import pickle
import sys
import types
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast, overload

from salbench import _core, datasets
from salbench.datasets.dataset import Dataset
from salbench.datasets.records import Item
from salbench.models.function import Learned, Model, Predict, described, key_of, version_of
from salbench.runs.results import Results
from salbench.runs.run import carry_out
from salbench.runs.settings import Settings, settings_of
from salbench.shapes.shape import Shape
from salbench.shapes.stages import fpfh, partial_mesh
from salbench.system.files import replace_file
from salbench.system.types import ArrayLike

if TYPE_CHECKING:
    from salbench.runs.plan import Plan as Plan_

Fit = Callable[..., Predict]  # of a list of shapes, and of the number of the fold where it takes one


@overload
def cross_validate(
    fit: Fit | Model | Mapping[str, Fit | Model],
    data: str | os.PathLike[str] | datasets.Dataset,
    config: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    folds: int = 5,
    by: str = "class",
    split: str = "test",
    seed: int = 0,
    models: Mapping[str, Predict | Model | Mapping[str, Any] | None] | None = None,
    cache: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    reference: str | os.PathLike[str] | ArrayLike | None = None,
    keep: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool = True,
    keep_going: bool = False,
    plan: Literal[False] = False,
) -> Results: ...


@overload
def cross_validate(
    fit: Fit | Model | Mapping[str, Fit | Model],
    data: str | os.PathLike[str] | datasets.Dataset,
    config: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    folds: int = 5,
    by: str = "class",
    split: str = "test",
    seed: int = 0,
    models: Mapping[str, Predict | Model | Mapping[str, Any] | None] | None = None,
    cache: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    reference: str | os.PathLike[str] | ArrayLike | None = None,
    keep: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool = True,
    keep_going: bool = False,
    plan: Literal[True],
) -> "Plan_": ...


def cross_validate(
    fit: Fit | Model | Mapping[str, Fit | Model],
    data: str | os.PathLike[str] | datasets.Dataset,
    config: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    folds: int = 5,
    by: str = "class",
    split: str = "test",
    seed: int = 0,
    models: Mapping[str, Predict | Model | Mapping[str, Any] | None] | None = None,
    cache: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    reference: str | os.PathLike[str] | ArrayLike | None = None,
    keep: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: bool = True,
    keep_going: bool = False,
    plan: bool = False,
) -> "Results | Plan_":
    """Trains and scores models that learn, each shape by a model that saw neither it nor, by class, any shape of its class.

    The shapes with ground truth are dealt into folds. For each fold, `fit` gets the shapes of all others, and the function that it
    returns makes the maps of the fold. Training shapes are held in memory. Maps are cached by what `fit` depends on,
    as `Model` says, and by the contents of the shapes that it got: a fold is trained only if one of its maps is missing.

    Parameters
    ----------
    fit : callable, or dict of them by name
        Takes a list of `Shape` with ground truth, returns a function of a `Shape` without, as `run` takes them. It must return the same
        for the same shapes: fix its seeds. With a parameter `fold` it is also told which fold it trains, from 0. One that is given without a name is called MINE in the tables. As a `Model` it has version,
        depends, reads and cache as there. Scans are not among the shapes: `simulate_scans` and `carry_ground_truth` make them.
    data : path
        Folder of the data set.
    config : str, path or dict, optional
        As of `run`. The defaults of its options hold for the normals and descriptors of the training shapes.
    folds : int
        How many. At most one per class, or per mesh.
    by : str
        "class": shapes of a class stay together. "mesh": views and scans of a mesh stay together. "split": the data set's own splits, one
        model for all: it is scored on `split` and trained on all other splits; `Shape.split` tells them apart.
    split : str
        The split that is scored if `by` is "split".
    seed : int
        Folds follow from it and from the names of classes or meshes alone, so they are the same for everybody.
    models : dict, optional
        Others in the same tables, as of `run`: functions, or models of the program, such as {"LS": {}}. By default those of the
        configuration.
    keep : path, optional
        Folder of what was trained, as pickles: a fold that is there is loaded, not trained again. Pickles run code: keep your own alone.
    cache, out, reference, threads, progress, keep_going
        As of `run`.
    plan : bool
        True: nothing is trained, computed or written, and nothing of yours is called; the result is a `Plan` as of the function `plan`, whose
        `folds` names by model the folds that would be trained.

    Returns
    -------
    Results, or Plan
        `models` has, by name, how many folds this call trained ("trained"). `folds.csv` in its folder has a row per fold and item: which
        is scored by the model of the fold, and which it was trained on.

    Raises
    ------
    KeyError
        A split that there is not.
    ValueError
        Folds that cannot be made, ground truth of gaze that shapes in memory do not have, and what `run` raises.

    Examples
    --------
    >>> import numpy, pathlib, salbench, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for number, height in enumerate((1, 2, 3, 4)):
    ...     text = f"OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 {height}\\n3 0 2 1\\n3 0 1 3\\n3 1 2 3\\n3 2 0 3\\n"
    ...     for part, name, content in (("Meshes", "off", text), ("Distributions", "val", f"0\\n1\\n{height}\\n5\\n")):
    ...         (folder / part).mkdir(exist_ok=True)
    ...         _ = (folder / part / f"{number + 1}.{name}").write_text(content)
    >>> def fit(shapes):
    ...     weights, *_ = numpy.linalg.lstsq(numpy.vstack([shape.points for shape in shapes]),
    ...                                      numpy.concatenate([shape.ground_truth for shape in shapes]), rcond=None)
    ...     return lambda shape: shape.points @ weights
    >>> results = salbench.cross_validate(fit, folder, {"dataset": {"scans": False}, "metrics": {"names": ["cc"]}}, models={}, folds=2,
    ...                                   by="mesh", cache=folder / "cache", out=folder / "out", progress=False)
    >>> results.trained, results.models["MINE"]["trained"], len(results.scores)
    ({'MINE': 'cross-validated, 2 folds by mesh'}, 2, 4)
    """
    fits = fit if isinstance(fit, Mapping) else {"MINE": fit}
    if not fits:
        raise ValueError("fit names no model")
    if twice := [name for name in fits if name in (models or {})]:
        raise ValueError(f"models has {twice[0]}, which is the name of a model that is trained")
    if threads is not None:
        _core.thread_count(threads, "threads")
    settings = settings_of(config, data, models, cache, out, "scored", split if by == "split" else "", reference, keep_going)
    protocol = settings.protocol()
    options = protocol["dataset"]
    if options["participants"] == "simulated":
        raise ValueError("participants are simulated: there is no ground truth to train on")
    dataset = Dataset(data, items="scored") if isinstance(data, datasets.Dataset) else Dataset(options["layout"], data, items="scored")
    _require_same_truth(dataset, protocol)
    dealing = in_split(dataset._items, split) if by == "split" else dealt(dataset._items, folds, by, seed)
    if options["scans"]:
        dealing = with_scans(dealing)
    shapes = _Shapes(dataset, {name for names in dealing.training for name in names})
    learned = {name: _learned(name, one if isinstance(one, Model) else Model(cast(Predict, one)), dealing, shapes, progress, keep)
               for name, one in fits.items()}
    settings = dataclasses.replace(settings, functions={**learned, **settings.functions})
    if plan:
        from salbench.runs.plan import Plan as Planned, planned

        found, open_shapes = planned(settings)
        return Planned(found, {name: cast(_Learner, model.predict).to_train(open_shapes[name]) for name, model in learned.items()})
    results = carry_out(settings, threads, progress)
    replace_file(results.folder / "folds.csv", dealing.of(shapes.digests).csv().encode("utf-8", "surrogateescape"))
    return results


def _require_same_truth(dataset: Dataset, protocol: Mapping[str, Any]) -> None:
    """Throws ValueError where maps would be scored against another ground truth than a Dataset has, which is that of files, or else of gaze by the
    defaults."""
    recorded = protocol["dataset"]["participants"] == "recorded"
    other_gaze = protocol["gaze"] != Settings(yaml="{}").protocol()["gaze"]
    for item in dataset._items:
        if item.recorded and (recorded and item.truth or other_gaze and (recorded or not item.truth)):
            raise ValueError(f"{item.name}: is scored against another ground truth of gaze than models would be trained on, since `gaze` or `participants` "
                             "of the configuration are not the defaults: write that ground truth into a set of its own with salbench.datasets.write, "
                             "and cross-validate on that")


# --- which fold trains on what


@dataclass(frozen=True)
class Plan:
    how: str  # in tables: "cross-validated, 5 folds by class"
    fold_of: Mapping[str, int]  # by the name of a shape that gets a map
    training: Sequence[Sequence[str]]  # of each fold, in the order of the data set

    def of(self, readable: Container[str]) -> "Plan":
        """Training on these alone: a shape that cannot be read is given to no fit."""
        return dataclasses.replace(self, training=[[item for item in names if item in readable] for names in self.training])

    def csv(self) -> str:
        """A table of fold, item and role: "scored" or "trained on"."""
        rows = [(fold, item, "scored") for item, fold in self.fold_of.items()]
        rows += [(fold, item, "trained on") for fold, items in enumerate(self.training) for item in items]
        made = io.StringIO(newline="")
        csv.writer(made, lineterminator="\n").writerows([("fold", "item", "role"), *sorted(rows, key=lambda row: row[0])])
        return made.getvalue()


def dealt(items: Sequence[Item], folds: int, by: str, seed: int) -> Plan:
    """Classes or meshes, in an order that follows from seed and names, are dealt out like cards."""
    if by not in ("class", "mesh"):
        raise ValueError(f"by must be class, mesh or split, not {by!r}")
    if by == "class" and (without := [item.name for item in items if not item.category]):
        raise ValueError(f"{len(without)} of {len(items)} shapes have no class, such as {without[0]}: take by='mesh'")
    seed = _core.whole_number(seed, "seed", 0, 2**64 - 1)
    classes: dict[str, str] = {}  # of each mesh; its views may not part
    for item in items:
        classes.setdefault(item.shape_name, item.category)
    groups = {item.name: classes[item.shape_name] if by == "class" else item.shape_name for item in items}
    order = sorted(set(groups.values()), key=lambda group: hashlib.sha256(f"{seed}/{group}".encode("utf-8", "surrogateescape")).digest())
    if not isinstance(folds, numbers.Integral) or not 2 <= folds <= len(order):
        raise ValueError(f"folds must be 2 to {len(order)}, the number of {'classes' if by == 'class' else 'meshes'} with ground truth, "
                         f"not {folds!r}")
    number_of = {group: place % folds for place, group in enumerate(order)}
    fold_of = {name: number_of[group] for name, group in groups.items()}
    how = f"cross-validated, {folds} folds by {by}" + (f", seed {seed}" if seed else "")
    return Plan(how, fold_of, [[name for name, own in fold_of.items() if own != fold] for fold in range(folds)])


def in_split(items: Sequence[Item], split: str) -> Plan:
    """Trained on what is in other splits alone: shapes may be in several."""
    splits = {item.name: item.split.split("+") for item in items if item.split}
    scored = [item for item in items if split in splits.get(item.name, ())]
    training = [item for item in items if item.name in splits and split not in splits[item.name]]
    others = list(dict.fromkeys(name for item in training for name in splits[item.name]))
    if not scored or not others:
        known = ", ".join(dict.fromkeys(name for names in splits.values() for name in names)) or "none"
        raise KeyError(f"split {split!r}: nothing to {'train on' if scored else 'score'}; splits with ground truth: {known}")
    if shared := {item.shape_name for item in scored} & {item.shape_name for item in training}:
        raise ValueError(f"{min(shared)}: has views in split {split} and in another one")
    how = f"trained on split{'s' * (len(others) > 1)} {' and '.join(others)}"
    return Plan(how, {item.name: 0 for item in scored}, [[item.name for item in training]])


def with_scans(plan: Plan) -> Plan:
    fold_of = dict(plan.fold_of)
    for name, fold in plan.fold_of.items():
        for view in range(_core.views):
            if fold_of.setdefault(f"{name}_{view}", fold) != fold:
                raise ValueError(f"{name}_{view} is the name of a shape and of scan {view} of {name}, which are in two folds: "
                                 "rename it, or leave scans out")
    return dataclasses.replace(plan, fold_of=fold_of)


# --- what is trained


class _Shapes:
    """The shapes that something is trained on, held in memory, with digests of their contents."""

    def __init__(self, dataset: Dataset, names: set[str]) -> None:
        from salbench.models.fingerprint import fingerprint

        self._read: dict[str, Shape] = {}
        self.digests: dict[str, str] = {}
        self._ready: dict[tuple[str, tuple[str, ...]], Shape] = {}
        for name in dataset.ids:
            if name not in names:
                continue
            try:
                shape = self._read[name] = dataset[name]
            except (ValueError, OSError) as error:
                logging.getLogger("salbench").warning("%s: nothing is trained on it: %s", name, error)
                continue
            self.digests[name] = fingerprint(tuple(vars(shape)[field.name] for field in dataclasses.fields(shape) if field.name != "source"))

    def ready(self, name: str, reads: tuple[str, ...]) -> Shape:
        """With the parts that a run hands over, as it has them by default."""
        if (name, reads) not in self._ready:
            shape = self._read[name]
            faces, normals, descriptors = shape.faces, shape.normals, None
            assert normals is not None  # of a data set
            if faces is None and "faces" in reads:
                faces = partial_mesh(shape.points, normals)
            if "fpfh" in reads:
                descriptors = fpfh(shape.points, normals)
            parts = {"faces": faces if "faces" in reads else None, "normals": normals if "normals" in reads else None, "fpfh": descriptors}
            self._ready[name, reads] = Shape(**{**vars(shape), **parts})
        return self._ready[name, reads]


def _learned(name: str, fit: Model, plan: Plan, shapes: _Shapes, progress: bool, keep: str | os.PathLike[str] | None) -> Learned:
    if "source" in fit.reads:
        raise ValueError(f"{name} reads source, which is not known of shapes that something is trained on")
    version_of(name, fit)
    training = plan.of(shapes.digests).training
    key = key_of(name, fit)
    start = f"{key}\0version {fit.version}\0{fit.reads}"  # once: of what cannot be compared it is another in each call
    told = takes_fold(fit.predict)
    keys = [hashlib.sha256("\0".join([start, *(shapes.digests[item] for item in items), *([f"fold {fold}"] if told else [])]).encode()).hexdigest()
            for fold, items in enumerate(training)]
    kept = None if keep is None else _Kept(pathlib.Path(keep) / name, keys)
    learner = _Learner(name, fit, plan.fold_of, training, shapes, progress, kept)
    return Learned(learner, version=1, reads=fit.reads, keys={item: keys[fold] for item, fold in plan.fold_of.items()}, trained=plan.how,
                   description=described(fit.predict))


def takes_fold(fit: Callable[..., Any]) -> bool:
    try:
        return "fold" in inspect.signature(fit).parameters
    except (TypeError, ValueError):  # of no function of Python
        return False


@dataclass(frozen=True)
class _Kept:
    """What was trained, as a file per fold, named by all that it depends on."""

    folder: pathlib.Path
    keys: Sequence[str]

    def path(self, fold: int) -> pathlib.Path:
        return self.folder / f"{self.keys[fold]}.pickle"

    def load(self, fold: int) -> Predict | None:
        try:
            with open(self.path(fold), "rb") as file:
                return cast(Predict, pickle.load(file))
        except FileNotFoundError:
            return None
        except Exception as error:
            raise ValueError(f"{self.path(fold)}: cannot be loaded: {error}; remove it to have the fold trained again") from error

    def store(self, fold: int, predict: Predict) -> None:
        try:
            data = pickle.dumps(predict)
        except Exception as error:
            raise ValueError(f"what was trained cannot be kept: {error}; return an object of a class of a module, not a function within a function") from error
        self.folder.mkdir(parents=True, exist_ok=True)
        replace_file(self.path(fold), data)


class _Learner:
    """The function of a shape that a run calls for maps that are missing."""

    def __init__(self, name: str, fit: Model, fold_of: Mapping[str, int], training: Sequence[Sequence[str]], shapes: _Shapes,
                 progress: bool, kept: _Kept | None) -> None:
        self._name, self._fit, self._fold_of, self._training = name, fit, fold_of, training
        self._shapes, self._progress, self._kept = shapes, progress, kept
        self._made: dict[int, Predict | Exception] = {}
        self._traces: dict[int, types.TracebackType | None] = {}  # of those that could not be trained
        self._loaded = 0

    def __len__(self) -> int:
        """Folds that were trained."""
        return len(self._made) - self._loaded

    def to_train(self, shapes: Sequence[str]) -> list[int]:
        """The folds of some shapes that nobody has trained and kept."""
        folds = {self._fold_of[name] for name in shapes if name in self._fold_of}
        return sorted(fold for fold in folds if not (self._kept and self._kept.path(fold).exists()))

    def __call__(self, shape: Shape) -> ArrayLike:
        fold = self._fold_of[shape.id]
        if fold not in self._made:
            self._made[fold] = self._trained(fold)
        made = self._made[fold]
        if isinstance(made, Exception):  # fails each shape of the fold, and is not tried again
            raise made.with_traceback(self._traces[fold])
        return made(shape)

    def _trained(self, fold: int) -> Predict | Exception:
        names = self._training[fold]
        try:
            if self._kept and (known := self._kept.load(fold)):
                self._loaded += 1
                return known
            if self._progress:
                print(f"{self._name}: fold {fold + 1} of {len(self._training)}, training on {len(names)} shapes", file=sys.stderr)
            told = {"fold": fold} if takes_fold(self._fit.predict) else {}
            predict = cast(Fit, self._fit.predict)([self._shapes.ready(name, tuple(self._fit.reads)) for name in names], **told)
            if not callable(predict):
                raise TypeError(f"fit must return a function of a shape, not {type(predict).__name__}")
            if self._kept:
                self._kept.store(fold, predict)
            return predict
        except Exception as error:
            self._traces[fold] = error.__traceback__ and error.__traceback__.tb_next  # without this frame
            return error
