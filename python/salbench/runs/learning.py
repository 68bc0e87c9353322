# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that are trained while a run goes on. A learner is a model of a run whose function trains a fold when the first of its maps is missing in the
cache. The key of a map has what its fold was trained on, so maps of other folds stay."""

import dataclasses
import hashlib
import inspect
import logging
import os
import pathlib
import pickle
import sys
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from salbench.datasets.dataset import Dataset
from salbench.models.fingerprint import fingerprint
from salbench.models.function import Learned, Model, Predict, described, key_of, version_of
from salbench.runs.folds import Dealing
from salbench.shapes.shape import Shape
from salbench.shapes.stages import fpfh, partial_mesh
from salbench.system.files import replace_file
from salbench.system.types import ArrayLike

Fit = Callable[..., Predict]  # of a list of shapes, and of the number of the fold where it takes one


class TrainingShapes:
    """The shapes that something is trained on, held in memory, with digests of their contents."""

    def __init__(self, dataset: Dataset, names: set[str]) -> None:
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


def learned_model(name: str, fit: Model, dealing: Dealing, shapes: TrainingShapes, progress: bool, keep: str | os.PathLike[str] | None) -> Learned:
    if "source" in fit.reads:
        raise ValueError(f"{name} reads source, which is not known of shapes that something is trained on")
    version_of(name, fit)
    training = dealing.of(shapes.digests).training
    key = key_of(name, fit)
    start = f"{key}\0version {fit.version}\0{fit.reads}"  # once: of what cannot be compared it is another in each call
    told = takes_fold(fit.predict)
    keys = [hashlib.sha256("\0".join([start, *(shapes.digests[item] for item in items), *([f"fold {fold}"] if told else [])]).encode()).hexdigest()
            for fold, items in enumerate(training)]
    kept = None if keep is None else Kept(pathlib.Path(keep) / name, keys)
    learner = Learner(name, fit, dealing.fold_of, training, shapes, progress, kept)
    return Learned(learner, version=1, reads=fit.reads, keys={item: keys[fold] for item, fold in dealing.fold_of.items()}, trained=dealing.how,
                   description=described(fit.predict))


def takes_fold(fit: Callable[..., Any]) -> bool:
    try:
        return "fold" in inspect.signature(fit).parameters
    except (TypeError, ValueError):  # of no function of Python
        return False


@dataclass(frozen=True)
class Kept:
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


class Learner:
    """The function of a shape that a run calls for maps that are missing."""

    def __init__(self, name: str, fit: Model, fold_of: Mapping[str, int], training: Sequence[Sequence[str]], shapes: TrainingShapes,
                 progress: bool, kept: Kept | None) -> None:
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
