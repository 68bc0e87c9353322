# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that are trained during a run. A learner is a model whose function trains a fold when the first of
its maps is missing in the cache. The key of a map includes the training data of its fold, so maps of other
folds stay valid."""

import csv
import dataclasses
import hashlib
import inspect
import io
import logging
import math
import pathlib
import time
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, cast

import numpy as np

from salbench import _core
from salbench.datasets.dataset import Dataset
from salbench.models.fingerprint import Unwalkable, fingerprint
from salbench.models.function import Learned, Model, Predict, described, key_of, version_of
from salbench.runs.failed import kind_of
from salbench.runs.folds import Dealing
from salbench.runs.kept import Kept
from salbench.shapes.shape import Shape
from salbench.shapes.stages import fpfh, partial_mesh
from salbench.system.files import replace_file
from salbench.system.progress import say
from salbench.system.types import ArrayLike

Fit = Callable[..., Predict]  # takes a list of shapes, and optionally the fold's number
ALIKE = 2  # folds that fail with one message before training stops


class TrainingShapes:
    """Training shapes, held in memory, with digests of their contents."""

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
            self.digests[name] = fingerprint(
                tuple(
                    vars(shape)[field.name] for field in dataclasses.fields(shape) if field.name != "source"
                )
            )

    def ready(self, name: str, reads: tuple[str, ...]) -> Shape:
        """Returns a shape with the parts that a run provides, by default options."""
        if (name, reads) not in self._ready:
            shape = self._read[name]
            faces, normals, descriptors = shape.faces, shape.normals, None
            assert normals is not None  # from a data set
            if faces is None and "faces" in reads:
                faces = partial_mesh(shape.points, normals)
            if "fpfh" in reads:
                descriptors = fpfh(shape.points, normals)
            parts = {
                "faces": faces if "faces" in reads else None,
                "normals": normals if "normals" in reads else None,
                "fpfh": descriptors,
            }
            self._ready[name, reads] = Shape(**{**vars(shape), **parts})
        return self._ready[name, reads]


@dataclass(frozen=True)
class Training:
    """Options of a call of `cross_validate` for training."""

    keep: pathlib.Path | None  # folder of trained models
    progress: bool
    keep_going: bool  # True: trains all folds, even if the first ones fail alike
    learners: list["Learner"] = field(default_factory=list)  # of the call; they may share an estimator


def learned_model(name: str, fit: Model, dealing: Dealing, shapes: TrainingShapes, how: Training) -> Learned:
    if "source" in fit.reads:
        raise ValueError(f"{name} reads source, which is not known of shapes that something is trained on")
    version_of(name, fit)
    dealing = dealing.of(shapes.digests)
    key = key_of(name, fit)
    # once, since incomparable values give another key at each call
    start = f"{key}\0version {fit.version}\0{fit.reads}"
    told = takes_fold(fit.predict)
    keys = [
        hashlib.sha256(
            "\0".join(
                [start, *(shapes.digests[item] for item in items), *([f"fold {fold}"] if told else [])]
            ).encode()
        ).hexdigest()
        for fold, items in enumerate(dealing.training)
    ]
    learner = Learner(name, fit, dealing, keys, shapes, how)
    return Learned(
        learner,
        version=1,
        reads=fit.reads,
        keys={item: keys[fold] for item, fold in dealing.fold_of.items()},
        trained=dealing.how,
        description=described(fit.predict),
    )


class Failed(NamedTuple):
    """A fold that could not be trained, or whose maps cannot be made."""

    error: Exception
    trace: types.TracebackType | None  # below the frame that caught it

    @classmethod
    def of(cls, error: Exception) -> "Failed":
        return cls(error, error.__traceback__ and error.__traceback__.tb_next)


def takes_fold(fit: Callable[..., Any]) -> bool:
    try:
        return "fold" in inspect.signature(fit).parameters
    except (TypeError, ValueError):  # not a Python function
        return False


class Learner:
    """The function that a run calls for missing maps."""

    def __init__(
        self,
        name: str,
        fit: Model,
        dealing: Dealing,
        keys: Sequence[str],
        shapes: TrainingShapes,
        how: Training,
    ) -> None:
        """keys: identity of each fold, including all its dependencies."""
        self._name, self._fit, self._dealing, self._keys, self._shapes, self._how = (
            name,
            fit,
            dealing,
            keys,
            shapes,
            how,
        )
        self._kept = None if how.keep is None else Kept(how.keep / name, keys)
        self._made: dict[int, Predict | Failed] = {}
        self._first_maps: dict[int, tuple[Shape, str]] = {}  # with the digest of the map
        self._seconds: dict[int, float] = {}  # training time of the folds that this call trained
        self._failures: dict[int, Failed] = {}  # first failure of each fold, in training or in a map
        self._n_tried, self._apart, self._has_maps, self._is_unkept = 0, 0.0, False, False
        how.learners.append(self)

    @property
    def counts(self) -> dict[str, int]:
        """Folds that this call trained, and folds whose training failed, as in `Results.models`."""
        return {"trained": len(self._seconds), "failed": self._n_tried - len(self._seconds)}

    @property
    def fold_of(self) -> Mapping[str, int]:
        return self._dealing.fold_of

    @property
    def n_folds(self) -> int:
        return len(self._keys)

    @property
    def reads(self) -> tuple[str, ...]:
        """Parts of a shape, beside its points."""
        return tuple(self._fit.reads)

    def to_train(self, shapes: Sequence[str]) -> list[int]:
        """Folds of these shapes that are neither trained nor stored."""
        folds = {self._dealing.fold_of[name] for name in shapes if name in self._dealing.fold_of}
        return sorted(fold for fold in folds if not (self._kept and self._kept.path(fold).exists()))

    def costs(self, known: Mapping[str, str]) -> list[tuple[str, int, int, str, str]]:
        """Rows of training.csv. known: seconds of earlier trainings, by key."""
        rows = []
        for fold, (names, key) in enumerate(zip(self._dealing.training, self._keys)):
            seconds = self._seconds.get(fold)
            if seconds is None and self._kept:
                seconds = self._kept.seconds(fold)
            said = known.get(key, "") if seconds is None else f"{seconds:.3f}"
            rows.append((self._name, fold, len(names), key, said))
        return rows

    def predictors(self) -> dict[int, Predict]:
        """Trained models by fold, without folds that are neither trained by this call nor stored."""
        for fold in range(len(self._keys)):
            if fold not in self._made and self._kept and (kept := self._kept.load(fold)) is not None:
                self._made[fold] = kept
        return {fold: made for fold, made in sorted(self._made.items()) if not isinstance(made, Failed)}

    def seconds_apart(self) -> float:
        """Seconds of training and loading since the last call, to be excluded from the time of maps."""
        seconds, self._apart = self._apart, 0.0
        return seconds

    def __call__(self, shape: Shape) -> ArrayLike:
        fold = self._dealing.fold_of[shape.id]
        try:
            if fold not in self._made:
                begun = time.monotonic()
                try:
                    self._made[fold] = self._first_of(fold)
                finally:
                    self._apart += time.monotonic() - begun
            made = self._made[fold]
            if isinstance(made, Failed):  # fails each shape of the fold, without another try
                raise made.error.with_traceback(made.trace)
            values = _checked(made(shape), shape)
            if fold not in self._first_maps:
                self._first_maps[fold] = shape, _digest(values)
        except Exception as error:
            self._failures.setdefault(fold, Failed.of(error))
            raise
        self._has_maps = True
        return values

    def _first_of(self, fold: int) -> "Predict | Failed":
        """Trains or loads a fold. Once the first folds have failed alike, the others fail untrained."""
        try:
            if self._kept and (kept := self._kept.load(fold)) is not None:
                return kept
            if (
                not (self._has_maps or self._how.keep_going)
                and (failures := list(self._failures.values()))[ALIKE - 1 :]
            ):
                if len({(type(failed.error), kind_of(str(failed.error))) for failed in failures}) == 1:
                    return failures[0]
            return self._trained(fold)
        except Exception as error:
            return Failed.of(error)

    def _trained(self, fold: int) -> Predict:
        names = self._dealing.training[fold]
        if self._how.progress:
            n_begun = sum(learner._n_tried for learner in self._how.learners) + 1
            n_folds = sum(learner.n_folds for learner in self._how.learners)
            say(
                f"{self._name}: fold {fold}, training on {len(names)} shapes (training {n_begun} of at most"
                f" {n_folds})"
            )
        self._n_tried += 1
        shapes, told = [self._shapes.ready(name, self.reads) for name in names], (
            {"fold": fold} if takes_fold(self._fit.predict) else {}
        )
        before = _digest(self._fit.predict) if self._n_tried == 1 else ""
        others = [  # now, since a prediction may change a state of its own
            (learner, number, made, _digest(made))
            for learner in self._how.learners
            for number, made in learner._made.items()
            if not isinstance(made, Failed)
        ]
        begun = time.monotonic()
        predict = cast(Fit, self._fit.predict)(shapes, **told)
        if not callable(predict):
            raise TypeError(f"fit must return a function of a shape, not {type(predict).__name__}")
        seconds = time.monotonic() - begun
        if before and before != _digest(self._fit.predict):
            logging.getLogger("salbench").warning(
                "%s: fit changes what it uses itself (a global, an attribute), so each fold goes on from the one"
                " before%s: make it within fit",
                self._name,
                "" if self._fit.version is not None else ", and the next call trains again",
            )
        self._require_apart(others)
        self._seconds[fold] = seconds
        if self._kept:
            self._keep(self._kept, fold, predict)
        return predict

    def _require_apart(self, others: Iterable[tuple["Learner", int, Predict, str]]) -> None:
        """Throws ValueError if a training changed a fold that was made before; the models concerned make no
        further map. others: folds with their models, and the digests of these before the training."""
        changed = [
            learner
            for learner, fold, made, before in others
            if _digest(made) != before and learner._predicts_otherwise(fold, made)
        ]
        if changed:
            error = ValueError(
                "training this fold changed the model of another fold: make the network or estimator anew in"
                " each call of fit"
            )
            for learner in (self, *changed):
                learner._made = dict.fromkeys(range(learner.n_folds), Failed(error, None))
            raise error

    def _predicts_otherwise(self, fold: int, made: Predict) -> bool:
        """True if the first map of a fold is another now. A global that counts calls, for example, changes no
        map."""
        shape, known = self._first_maps.get(fold, (None, ""))
        return shape is None or _digest(made(shape)) != known

    def _keep(self, kept: Kept, fold: int, predict: Predict) -> None:
        """Stores a fold; if that fails, its maps are made anyway."""
        try:
            kept.store(fold, predict, self._seconds[fold])
        except Exception as error:
            if not self._is_unkept:
                self._is_unkept = True
                logging.getLogger("salbench").warning(
                    "%s: what is trained is not kept: %s; its maps are made all the same",
                    self._name,
                    " ".join(str(error).split()),
                )


def _digest(value: object) -> str:
    """Fingerprint; "" if there is none."""
    try:
        return fingerprint(value)
    except Unwalkable:
        return ""


def _checked(given: ArrayLike, shape: Shape) -> ArrayLike:
    """Checks the values of a map; invalid ones fail the fold. The run checks the count for faces that the
    shape does not have."""
    n_faces = math.prod(np.shape(given)) if shape.faces is None else len(shape.faces)
    _core.check_values(given, "the map", len(shape.points), n_faces)
    return given


def write_costs(table: pathlib.Path, learners: Iterable[Learner]) -> None:
    """Writes training.csv; seconds of folds that were trained before come from the files of `keep`, or else
    from the existing table."""
    known = {}
    if table.is_file():
        with open(table, encoding="utf-8", newline="") as file:
            known = {row["key"]: row["seconds"] for row in csv.DictReader(file) if row.get("key")}
    made = io.StringIO(newline="")
    rows = [row for learner in learners for row in learner.costs(known)]
    csv.writer(made, lineterminator="\n").writerows([("model", "fold", "shapes", "key", "seconds"), *rows])
    replace_file(table, made.getvalue().encode())
