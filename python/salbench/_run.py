# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark as a function call, with models that are functions of Python."""

import contextvars
import functools
import hashlib
import inspect
import logging
import operator
import os
import secrets
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from salbench import _core, datasets
from salbench._by_name import names_of
from salbench._errors import InputError
from salbench._files import path_of, require_folder
from salbench._results import Results
from salbench._settings import Settings
from salbench._shape import Shape
from salbench._types import ArrayLike
from salbench._yaml import flow_text

Predict = Callable[[Shape], ArrayLike]
PARTS = ("normals", "faces", "fpfh", "source")
MOST_SAID = 300  # characters of a description
_AT_WORK: contextvars.ContextVar[frozenset[str]] = contextvars.ContextVar("caches of the runs around", default=frozenset())


@dataclass(frozen=True)
class Model:
    """A function of a shape as a model of the benchmark, with what its maps depend on.

    Maps are computed again when the function changes or something that it depends on: its code, its defaults and
    closure, globals and functions that it names, the state of an object, arrays and networks by their values, installed
    packages by version; as they are when `run` is called. Files, the environment and clocks that it reads are not seen:
    name files in `depends`. If something cannot be compared, such as a lock or an open file, one line names it, and the
    maps are computed in each call.

    Parameters
    ----------
    predict : callable
        Takes a `Shape`, returns one finite value per point, or per face where faces are scored.
    version : int, optional
        From 0 to 2**31 - 1. Your promise that maps are the same as long as it is: only it and `depends` count then.
    depends : sequence, optional
        What else counts: files (text or path, by content), and any other value, by content.
    reads : sequence of str
        Parts of the shape beside its points that are handed over: some of "normals", "faces", "fpfh", and "source", the path of the
        shape's file, whose content counts then, with that of its textures.
    cache : bool
        False: maps are computed in each call.
    trained_on : sequence of str
        Items and splits that it was trained on: tables and report name those of them that are scored.
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
    """One that `cross_validate` makes. Its function trains; `len` of it says how often it has."""

    keys: Mapping[str, str] = field(default_factory=dict)  # by shape: of all that its map was trained on
    trained: str = ""  # "cross-validated, 5 folds by class"
    description: str = ""  # of the function that trains


@dataclass(frozen=True)
class Function:
    """A model for the compiled part: what it calls, and the texts that its maps are found by."""

    name: str
    predict: Predict
    reads: list[str]
    version: int
    key: str
    trained_keys: Mapping[bytes, str]
    trained: str
    trained_on: list[str]
    description: str

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
        return cls(name, made.predict, [part for part in ("points", *PARTS) if part in made.reads], version_of(name, made), key_of(name, made),
                   {os.fsencode(item): key for item, key in keys.items()}, trained, [*map(str, made.trained_on)], description)


def described(function: object) -> str:
    """The first paragraph of its docstring, or of that of its class, as a line for tables and reports; "" where there is none."""
    while isinstance(function, functools.partial):
        function = function.func
    said = function.__doc__ if inspect.isroutine(function) else vars(type(function)).get("__doc__")
    if not isinstance(said, str):
        return ""
    line = " ".join(inspect.cleandoc(said).partition("\n\n")[0].split())
    return line[:MOST_SAID].encode(errors="replace").decode()


def model(version: int | None = None, depends: Iterable[Any] = (), reads: Iterable[str] = ("normals", "faces"),
          cache: bool = True) -> Callable[[Predict], Model]:
    """Decorator that makes a `Model` of a function; `version`, `depends`, `reads` and `cache` as there.

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


def run(
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
) -> Results:
    """Scores models on a data set: what is missing in the cache is computed, the rest is read.

    Writes into two folders, by default of the working folder: artefacts into `cache` ("salbench-cache"), tables into `out`
    ("salbench-out/NAME" of the configuration).

    A function runs in the thread that called, one shape at a time, while everything else goes on in other threads.
    What it raises, or returns that is no map, fails that shape alone: see `Results.failures`. Ctrl-C ends the run
    in order, with its scores written; the next call goes on from there. Conclusions from the scores are drawn when a
    table of them is first asked for.

    Parameters
    ----------
    config : str, path or dict, optional
        A configuration file, the name of one that the program has ("shrec07", the default; "protocols/3dva"), or its content.
    data, cache, out : path, optional
        Folders, in place of the configuration's: the data set; artefacts; tables. `data` may be a `salbench.datasets.Dataset` of one's own.
    models : dict, optional
        By name: a function or `Model`; or options of one that the program has, such as {"LS": {}}; or a variant of one of these, such as
        {"LS-08": {"model": "LS", "foci_sigma": 0.08}}, or several, {"LS-grid": {"model": "LS", "grid": {"foci_sigma": [0.05, 0.1]}}}. In
        place of those of the configuration.
    items : str or sequence of str, optional
        Items to be run: "1-20,52", "scored" for those with ground truth, or a list of names. All by default; an empty
        list names none, which is a ValueError. Maps are matched to the mean over all items of the data set all the same.
    split : str, optional
        Items of one split alone, such as "test"; "" for all, where the configuration names one.
    reference : path or (100,) array, optional
        Histogram that maps are matched to, in place of the mean over the data set: of another run
        (`Results.reference`), or a CSV file with a column GS; or "items" for the mean over the items that are run. One that does
        not sum to 100, such as probabilities, is scaled with a warning.
    threads : int, optional
        1 to 1024. By default all cores that the process may use.
    progress : bool
        Show a bar, where tqdm is installed, and print at the end how many maps of each model are new (`Results.models`).
    keep_going : bool
        A command or function without any map yet that fails on the first five shapes, in their order, with one and the same message is not
        tried on the others: one line says so. True: it is tried on all.

    Returns
    -------
    Results

    Raises
    ------
    KeyError
        An item or a split that there is not.
    ValueError
        A configuration, a data set or another argument that cannot be used.
    OSError
        A cache or a folder that cannot be written to; FileNotFoundError for data or a configuration that is not there.
    KeyboardInterrupt
        After Ctrl-C, once the run has ended in order.
    """
    settings, functions = settings_of(config, data, models, cache, out, items, split, reference, keep_going)
    return carry_out(settings, functions, threads, progress)


def settings_of(config: Any, data: Any, models: Any, cache: Any, out: Any, items: Any, split: str | None,
                reference: Any, keep_going: bool = False) -> tuple[Settings, list[tuple[str, Predict | Model]]]:
    """What `carry_out` takes, of arguments of `run`: settings, and the models that are functions."""
    dataset, data = (data, data.root or ".") if isinstance(data, datasets.Dataset) else (None, data)
    data, cache, out = (given if given is None else path_of(given, name) for name, given in (("data", data), ("cache", cache), ("out", out)))
    if data is not None:
        require_folder(data)
    if models is not None and not isinstance(models, Mapping):
        raise ValueError(f"models must be a dict by name, such as {_models_of(models)}, not {models!r:.100}")
    functions = [] if models is None else [
        (name, given) for name, given in models.items() if callable(given) or isinstance(given, Model)]
    others = None if models is None else {
        name: {} if given is None else given for name, given in models.items() if not (callable(given) or isinstance(given, Model))}
    settings = Settings(
        path=None if isinstance(config, Mapping) else name_of(config), yaml=text_of(config, "config") if isinstance(config, Mapping) else None,
        models=None if others is None else text_of(others, "models"), data=data, dataset=dataset, cache=cache, out=out, split=split,
        keep_going=bool(keep_going),
        reference=path_of(reference, "reference") if isinstance(reference, (str, os.PathLike)) else reference,
        items=items if items is None else os.fsencode(items) if isinstance(items, str) else [os.fsencode(name) for name in names_of(items)])
    if items is not None and not settings.items:
        raise ValueError("items is empty: name some, or leave it out to run all")
    return settings, functions


def _models_of(given: Any) -> str:
    """What somebody meant who gave names, or one function, in place of a dict."""
    names = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    entries = [f"{getattr(name, '__name__', name)!r}: {'{}' if isinstance(name, str) else 'function'}" for name in names[:3]]
    return "{" + (", ".join(entries) or "'LS': {}") + "}"


def carry_out(settings: Settings, functions: Sequence[tuple[str, Predict | Model]], threads: int | None, progress: bool) -> Results:
    threads = _core.thread_count(threads, "threads")
    going = _core.Run(settings, [Function.of(name, given) for name, given in functions])
    cache = os.path.realpath(going.cache)
    if cache in _AT_WORK.get():
        raise InputError(f"{cache}: a function of a run has started this run over the same cache, where each would wait for the other: "
                         "give it a cache of its own with cache=")
    before = _AT_WORK.set(_AT_WORK.get() | {cache})
    try:
        with _Bar(progress) as bar:
            going.carry_out(threads, bar)
    finally:
        _AT_WORK.reset(before)
    results = Results(going.output, going)
    for name, given in functions:
        if isinstance(given, Learned):
            results.models[name]["trained"] = operator.length_hint(given.predict)
    if progress:
        print(*results._model_lines(), sep="\n", file=sys.stderr)
    return results


def text_of(config: Mapping[str, Any], name: str) -> str:
    """A configuration in memory, as the program reads one. name: of the argument."""
    def plain(value: Any) -> Any:
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        raise InputError(f"{name}: a {type(value).__name__} is neither a text, a number, a list nor a dict")

    try:
        return flow_text(config, default=plain)
    except RecursionError:
        raise InputError(f"{name}: is nested too deeply") from None
    except TypeError as error:  # of a key
        raise InputError(f"{name}: {error}") from None


def name_of(config: object) -> str:
    """Of a configuration: its file, or what the program calls it."""
    if config is None:
        return "shrec07"
    if not isinstance(config, (str, os.PathLike)):
        raise ValueError(f"config must be a file, a name or a dict, not {config!r:.100}")
    return path_of(config, "config")


def version_of(name: str, made: Model) -> int:
    return 1 if made.version is None else _core.whole_number(made.version, f"models: {name}: version", 0, 2**31 - 1)


def key_of(name: str, made: Model) -> str:
    """Text that stands for what maps depend on; one that no other call has if that cannot be told."""
    from salbench._fingerprint import Unwalkable, file_digest, fingerprint

    if not made.cache:
        return _key_of_this_call()
    parts: list[str] = []
    try:
        if made.version is None:
            parts.append(f"function {fingerprint(made.predict)}")
        parts += [f"file {file_digest(what)}" if isinstance(what, (str, os.PathLike)) else f"value {fingerprint(what)}" for what in made.depends]
    except Unwalkable as error:
        logging.getLogger("salbench").warning(
            "%s: its maps are computed anew in each call, since it depends on what cannot be compared: %s; "
            "salbench.Model(..., version=1) keeps them", name, error)
        return _key_of_this_call()
    return hashlib.sha256("\0".join(parts).encode()).hexdigest() if parts else "by version"


def _key_of_this_call() -> str:
    return f"of one call: {secrets.token_hex(16)}"


def _raised(error: BaseException, trace: Any) -> tuple[str, str]:
    """An exception as one line, with the innermost line of code; and its whole traceback."""
    frames = traceback.extract_tb(trace)
    place = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    try:
        text = f"{type(error).__name__}: {error}"
    except Exception:  # of its own __str__
        text = type(error).__name__
    lines = " ".join(text.split()) + place, "".join(traceback.format_exception(type(error), error, trace)).rstrip()
    line, whole = (one.encode("utf-8", "backslashreplace").decode().replace("\0", "\\0") for one in lines)
    return line, whole


class _Bar:
    """Progress with tqdm, in a terminal or a notebook; nothing where it is not installed."""

    def __init__(self, wanted: bool) -> None:
        self._bar: Any = None
        self._what = ""
        self._tqdm: Any = None
        if wanted:
            try:
                from tqdm.auto import tqdm

                self._tqdm = tqdm
            except ImportError:
                pass

    def __enter__(self) -> "_Bar":
        return self

    def __call__(self, what: str, done: int, total: int, _at_work: str) -> None:
        if self._tqdm is None or total == 0:
            return
        if self._bar is None or what != self._what:
            self.__exit__()
            self._bar, self._what = self._tqdm(total=total, desc=what, leave=False), what
        self._bar.update(done - self._bar.n)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
