# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as Python functions, and the dependencies of their maps."""

import functools
import hashlib
import inspect
import logging
import os
import secrets
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from salbench import _core
from salbench.shapes.shape import Shape
from salbench.system.types import ArrayLike

Predict = Callable[[Shape], ArrayLike]
PARTS = ("normals", "faces", "fpfh", "source")
OF_ONE_CALL = "of one call: "  # begin of keys that no other call has
MOST_SAID = 300  # characters of a description


@dataclass(frozen=True)
class Model:
    """A function of a shape as a model of the benchmark, with the dependencies of its maps.

    Maps are computed again when the function or one of its dependencies changes: its code, defaults and
    closure, globals and functions that it names, the state of an object, arrays and networks by value,
    installed packages by version; as of the call of `run`. Files, the environment and clocks are not tracked:
    name files in `depends`. If a dependency cannot be compared, such as a lock or an open file, one line
    names it, and the maps are computed in each call.

    Parameters
    ----------
    predict : callable
        Takes a `Shape`, returns one finite value per point, or per face if faces are scored.
    version : int, optional
        From 0 to 2**31 - 1. Your promise that maps are the same for the same version: only it and `depends`
        count then.
    depends : sequence, optional
        Further dependencies: files (text or path, by content), and any other value, by content.
    reads : sequence of str
        Parts of the shape that the function gets in addition to points: "normals", "faces", "fpfh", and
        "source", the path of the shape's file, whose content then counts, as do its textures.
    cache : bool
        False: maps are computed in each call.
    trained_on : sequence of str
        Items and splits that it was trained on: tables and report name those that are scored.
    """

    predict: Predict
    version: int | None = None
    depends: Iterable[Any] = ()
    reads: Iterable[str] = ("normals", "faces")
    cache: bool = True
    trained_on: Iterable[str] = ()

    def __post_init__(self) -> None:
        for name in ("depends", "reads", "trained_on"):  # a generator would be empty in the second run
            given = getattr(self, name)
            if isinstance(given, (str, bytes, os.PathLike)):
                raise ValueError(f"{name} must be a sequence, such as [{given!r}]")
            object.__setattr__(self, name, tuple(given))
        if not callable(self.predict):
            raise ValueError(f"predict must be a function of a shape, not {self.predict!r:.100}")


@dataclass(frozen=True)
class Learned(Model):
    """A model made by `cross_validate`. Its function trains (`Learner`)."""

    # by shape: identity of the training data of its map
    keys: Mapping[str, str] = field(default_factory=dict)
    trained: str = ""  # "cross-validated, 5 folds by class"
    description: str = ""  # for the function that trains


@dataclass(frozen=True)
class Function:
    """A model for the compiled part: its function, and the texts that identify its maps."""

    name: str
    predict: Predict
    reads: list[str]
    version: int
    key: str
    trained_keys: Mapping[bytes, str]
    trained: str
    trained_on: list[str]
    description: str
    learner: Predict | None  # the function, if it trains when called

    @classmethod
    def of(cls, name: str, given: Predict | Model) -> "Function":
        if not isinstance(name, str):
            raise ValueError(f"models: the name {name!r:.100} must be a text")
        made = given if isinstance(given, Model) else Model(given)
        for part in made.reads:
            if part not in ("points", *PARTS):
                raise KeyError(f"models: {name} reads '{part}', expected some of {', '.join(PARTS)}")
        keys, trained = (made.keys, made.trained) if isinstance(made, Learned) else ({}, "")
        description = made.description if isinstance(made, Learned) else described(made.predict)
        return cls(
            name,
            made.predict,
            [part for part in ("points", *PARTS) if part in made.reads],
            version_of(name, made),
            key_of(name, made),
            {os.fsencode(item): key for item, key in keys.items()},
            trained,
            [*map(str, made.trained_on)],
            description,
            made.predict if isinstance(made, Learned) else None,
        )


def described(function: object) -> str:
    """First paragraph of the docstring of the function or of its class, as a line for tables and reports; ""
    without one."""
    while isinstance(function, functools.partial):
        function = function.func
    said = function.__doc__ if inspect.isroutine(function) else vars(type(function)).get("__doc__")
    if not isinstance(said, str):
        return ""
    line = " ".join(inspect.cleandoc(said).partition("\n\n")[0].split())
    return line[:MOST_SAID].encode(errors="replace").decode()


def model(
    version: int | None = None,
    depends: Iterable[Any] = (),
    reads: Iterable[str] = ("normals", "faces"),
    cache: bool = True,
) -> Callable[[Predict], Model]:
    """Decorator that turns a function into a `Model`, with the same `version`, `depends`, `reads` and
    `cache`.

    Examples
    --------
    >>> import salbench
    >>> @salbench.model(version=2)
    ... def height(shape):
    ...     return shape.points[:, 2]
    >>> height.version
    2
    """
    return lambda predict: Model(predict, version, depends, reads, cache)


def version_of(name: str, made: Model) -> int:
    return (
        1
        if made.version is None
        else _core.whole_number(made.version, f"models: {name}: version", 0, 2**31 - 1)
    )


def key_of(name: str, made: Model) -> str:
    """Identity of a function's maps; unique to this call if it cannot be determined."""
    from salbench.models.fingerprint import Unwalkable, file_digest, fingerprint

    if not made.cache:
        return _key_of_this_call()
    parts: list[str] = []
    try:
        if made.version is None:
            parts.append(f"function {fingerprint(made.predict)}")
        elif not isinstance(made, Learned):  # whose shapes have keys; nothing else tells versions apart
            parts.append(f"name {name}")
        parts += [
            (
                f"file {file_digest(what)}"
                if isinstance(what, (str, os.PathLike))
                else f"value {fingerprint(what)}"
            )
            for what in made.depends
        ]
    except Unwalkable as error:
        logging.getLogger("salbench").warning(
            (
                "%s: its maps are computed anew in each call, since it depends on what cannot be compared:"
                " %s; salbench.Model(..., version=1) keeps them"
            ),
            name,
            error,
        )
        return _key_of_this_call()
    return hashlib.sha256("\0".join(parts).encode()).hexdigest() if parts else "by version"


def _key_of_this_call() -> str:
    return f"{OF_ONE_CALL}{secrets.token_hex(16)}"
