# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark as a function call, with models that are functions of Python."""

import errno
import hashlib
import inspect
import json
import os
import pathlib
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import ArrayLike

from salbench import _core
from salbench._results import Results
from salbench._shape import Shape

Predict = Callable[[Shape], ArrayLike]
PARTS = ("normals", "faces", "fpfh")


@dataclass(frozen=True)
class Model:
    """A function of a shape as a model of the benchmark, with what its maps depend on.

    Parameters
    ----------
    predict : callable
        Takes a `Shape`, returns one finite value per point.
    version : int, optional
        Maps are computed again when it changes, and not when the function's text does. Without one its source text
        counts.
    depends : sequence, optional
        What else counts: files (by content), functions (by source text), and any value (by its `repr`).
    reads : sequence of str
        Parts of the shape beside its points that are handed over: some of "normals", "faces", "fpfh".
    """

    predict: Predict
    version: int | None = None
    depends: Iterable[Any] = field(default=())
    reads: Iterable[str] = ("normals", "faces")


def model(version: int | None = None, depends: Iterable[Any] = (), reads: Iterable[str] = ("normals", "faces")
          ) -> Callable[[Predict], Model]:
    """Decorator that makes a `Model` of a function; `version`, `depends` and `reads` as there.

    Examples
    --------
    >>> import salbench
    >>> @salbench.model(version=2)
    ... def height(shape):
    ...     return shape.points[:, 2]
    >>> height.version
    2
    """
    return lambda predict: Model(predict, version, depends, reads)


def run(
    config: str | os.PathLike[str] | Mapping[str, Any] | None = None,
    *,
    data: str | os.PathLike[str] | None = None,
    models: Mapping[str, Predict | Model | Mapping[str, Any] | None] | None = None,
    cache: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    items: str | Iterable[str] | None = None,
    threads: int | None = None,
    progress: bool = True,
) -> Results:
    """Scores models on a data set: what is missing in the cache is computed, the rest is read.

    A function runs in the thread that called, one shape at a time, while everything else goes on in other threads.
    What it raises, or returns that is no map, fails that shape alone: see `Results.failures`. Ctrl-C ends the run
    in order, with its scores written; the next call goes on from there. Conclusions from the scores are drawn when a
    table of them is first asked for.

    Parameters
    ----------
    config : str, path or dict, optional
        A configuration file, the name of one that the program has ("shrec07", the default), or its content.
    data, cache, out : path, optional
        Folders, in place of the configuration's: the data set; artefacts ("salbench-cache"); tables
        ("salbench-out/NAME").
    models : dict, optional
        By name: a function or `Model`; or options of one that the program has, such as {"LS": {}}. In place of those of
        the configuration.
    items : str or sequence of str, optional
        Items to be run: "1-20,52", "scored" for those with ground truth, or a list of names. All by default. Maps are
        matched to the mean over all items of the data set all the same.
    threads : int, optional
        All cores by default.
    progress : bool
        Show a bar, where tqdm is installed.

    Returns
    -------
    Results

    Raises
    ------
    ValueError
        A configuration, a data set or an argument that cannot be used.
    OSError
        A cache or a folder that cannot be written to; FileNotFoundError for data or a configuration that is not there.
    KeyboardInterrupt
        After Ctrl-C, once the run has ended in order.
    """
    if data is not None and not os.path.isdir(data):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fspath(data))
    functions = [] if models is None else [
        (name, given) for name, given in models.items() if callable(given) or isinstance(given, Model)]
    others = None if models is None else {
        name: given or {} for name, given in models.items() if not (callable(given) or isinstance(given, Model))}
    settings = {
        "path": None if isinstance(config, Mapping) else _configuration(config),
        "yaml": json.dumps(config) if isinstance(config, Mapping) else None,
        "models": json.dumps(others) if others else None,
        "only_functions": others == {},
        "data": data and os.fspath(data),
        "cache": cache and os.fspath(cache),
        "out": out and os.fspath(out),
        "items": items if items is None or isinstance(items, str) else ",".join(map(str, items)),
    }
    threads = len(os.sched_getaffinity(0)) if threads is None else threads
    if threads < 1:
        raise ValueError(f"threads must be at least 1, not {threads}")
    going = _core.Run(settings, [_row(name, given) for name, given in functions])
    with _Bar(progress) as bar:
        going.carry_out(threads, bar)
    return Results(going.output, going)


def _configuration(given: str | os.PathLike[str] | None) -> str:
    """The path of a configuration, which may be the name of one that is installed."""
    name = "shrec07" if given is None else os.fspath(given)
    if os.path.exists(name):
        return name
    here = pathlib.Path(__file__).parent
    folders = [here / "configs", pathlib.Path("/usr/share/salbench/configs")]
    for folder in folders:
        if (folder / f"{name}.yaml").is_file():
            return str(folder / f"{name}.yaml")
    raise FileNotFoundError(f"{name}: no such configuration, neither a file nor a name in {folders[0]} or {folders[1]}")


def _row(name: str, given: Predict | Model) -> tuple[str, Predict, list[str], int, str]:
    made = given if isinstance(given, Model) else Model(given)
    reads = list(made.reads)
    for part in reads:
        if part not in (*PARTS, "points"):
            raise KeyError(f"models: {name} reads '{part}', expected some of {', '.join(PARTS)}")
    parts = [] if made.version is not None else [_source_of(made.predict)]
    parts += [_content_of(what) for what in made.depends]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest() if parts else "by version"
    return name, made.predict, [part for part in ("points", *PARTS) if part in reads], made.version or 1, key


def _source_of(function: Any) -> str:
    """Text that stands for a function: its source, or where there is none its byte code."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        code = getattr(function, "__code__", None) or getattr(type(function).__call__, "__code__", None)
        if code is None:
            raise ValueError(f"{function!r} has no source text that says when its maps are stale: give a version") from None
        return _code_text(code)


def _code_text(value: Any) -> str:
    """A constant of byte code, or the code itself, as text without addresses and without the order of a set."""
    if inspect.iscode(value):
        return f"code({value.co_code.hex()}, {_code_text(value.co_consts)}, {value.co_names!r})"
    if isinstance(value, tuple):
        return f"({', '.join(map(_code_text, value))})"
    if isinstance(value, frozenset):
        return f"{{{', '.join(sorted(map(_code_text, value)))}}}"
    return repr(value)


def _content_of(what: Any) -> str:
    if isinstance(what, (str, os.PathLike)):
        with open(what, "rb") as file:
            return hashlib.sha256(file.read()).hexdigest()
    return _source_of(what) if callable(what) or inspect.ismodule(what) else repr(what)


def _raised(error: BaseException, trace: Any) -> str:
    """An exception as one line, with the innermost line of code."""
    frames = traceback.extract_tb(trace)
    place = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    try:
        text = f"{type(error).__name__}: {error}"
    except Exception:  # of its own __str__
        text = type(error).__name__
    return " ".join(text.split()) + place


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

    def __call__(self, what: str, done: int, total: int) -> None:
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
