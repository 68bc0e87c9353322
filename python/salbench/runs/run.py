# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the benchmark from Python, with functions as models."""

import contextvars
import logging
import os
import pathlib
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, cast

from salbench import _core, datasets
from salbench.models.function import OF_ONE_CALL, Function, Learned, Model, Predict, key_of
from salbench.runs import outcome
from salbench.runs.results import Results
from salbench.runs.settings import Settings, settings_of
from salbench.system.errors import InputError
from salbench.system.progress import Progress, say
from salbench.system.types import ArrayLike

if TYPE_CHECKING:
    from salbench.runs.learning import Learner

_AT_WORK: contextvars.ContextVar[frozenset[str]] = contextvars.ContextVar(
    "caches of the runs around", default=frozenset()
)


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
    """Scores models on a data set. Results in the cache are read, missing ones are computed.

    Writes artefacts into `cache` (default: "salbench-cache"), and tables into `out` (default:
    "salbench-out/NAME" of the configuration).

    A function runs in the calling thread, one shape at a time, while everything else goes on in other
    threads. An exception or an invalid map fails only that shape: see `Results.failures`. Models without any
    map are named in a warning, and in `Results.failed`. Ctrl-C ends the run in order, with its scores
    written; the next call continues from there. Conclusions are drawn from the scores on first access to
    their tables.

    Parameters
    ----------
    config : str, path or dict, optional
        A configuration file, the name of one that the program has ("shrec07", the default; "protocols/3dva"),
        or its content.
    data, cache, out : path, optional
        Folders, in place of the configuration's: the data set; artefacts; tables. `data` may be your own
        `salbench.datasets.Dataset`. Give each run its own `out`: a later run into the same folder replaces
        the tables, and the `Results` of the earlier one then raise ValueError for tables not yet read.
    models : dict, optional
        By name: a function or `Model`; or options of one of the program's models, such as {"LS": {}}; or a
        variant of one of these, such as {"LS-08": {"model": "LS", "foci_sigma": 0.08}}, or several,
        {"LS-grid": {"model": "LS", "grid": {"foci_sigma": [0.05, 0.1]}}}. Replaces those of the
        configuration.
    items : str or sequence of str, optional
        Items to run: "1-20,52", "scored" for those with ground truth, or a list of names. Default: all; an
        empty list is a ValueError. Maps are matched to the mean over all items of the data set in any case.
    split : str, optional
        Only items of one split, such as "test"; "" for all, if the configuration names one.
    reference : path or (100,) array, optional
        Histogram for matching of maps, in place of the mean over the data set: of another run
        (`Results.reference`), or a CSV file with a column GS; or "items" for the mean over the items that are
        run. Other sums than 100, such as of probabilities, are scaled with a warning.
    threads : int, optional
        1 to 1024. Default: all cores that the process may use.
    progress : bool
        Show a bar, or a line every ten seconds without a terminal or notebook; print at the end who leads,
        the number of new maps per model (`Results.models`), and the folders of results and cache.
    keep_going : bool
        False: a command or function that fails on the first five shapes, in their order, with the same
        message and has no map yet is not tried on the others; one line says so. True: tries all shapes.

    Returns
    -------
    Results

    Raises
    ------
    KeyError
        An unknown item or split.
    ValueError
        An invalid configuration, data set or other argument.
    OSError
        A cache or a folder that cannot be written; FileNotFoundError for missing data or configuration.
    KeyboardInterrupt
        After Ctrl-C, once the run has ended in order.
    """
    results = carry_out(
        settings_of(config, data, models, cache, out, items, split, reference, keep_going), threads, progress
    )
    results._warn_of_failed()
    return results


def carry_out(
    settings: Settings,
    threads: int | None,
    progress: bool,
    write_tables: Callable[[pathlib.Path], None] = lambda folder: None,
) -> Results:
    """write_tables: writes further tables into the folder, before conclusions are drawn."""
    threads = _core.thread_count(threads, "threads")
    functions = settings.own_models
    going = _core.Run(settings, functions)
    cache = os.path.realpath(going.cache)
    if cache in _AT_WORK.get():
        raise InputError(
            f"{cache}: a function of a run has started this run over the same cache, where each would wait"
            " for the other: give it a separate cache with cache="
        )
    before = _AT_WORK.set(_AT_WORK.get() | {cache})
    try:
        learns = any(isinstance(given, Learned) for given in settings.functions.values())
        with Progress(quiet=not progress, estimates=not learns) as bar:
            going.carry_out(threads, bar)
    finally:
        _AT_WORK.reset(before)
    results = Results(going.output, going)
    write_tables(results.folder)
    for name, given in settings.functions.items():
        if isinstance(given, Learned):
            results.models[name] |= cast("Learner", given.predict).counts
    for function in functions:
        given = settings.functions[function.name]
        if results.models[function.name]["computed"] and not isinstance(given, Learned):
            _warn_of_state(function, given if isinstance(given, Model) else Model(given))
    if progress:
        _say_outcome(results, going)
    return results


def _warn_of_state(function: Function, made: Model) -> None:
    """Warns if calls of a function changed what identifies its maps."""
    if made.cache and made.version is None and not function.key.startswith(OF_ONE_CALL):
        if key_of(function.name, made) != function.key:
            logging.getLogger("salbench").warning(
                (
                    "%s: calling it changed what it depends on, so its maps are computed again in the next"
                    " call; salbench.Model(..., version=1) keeps them"
                ),
                function.name,
            )


def _say_outcome(results: Results, going: _core.Run) -> None:
    """Prints who leads, new maps, folders, and next steps."""
    found = outcome.of(going)
    results._concluded = bool(found.leaders)
    trouble = found.missing or found.failure
    lines = [
        *found.sentences,
        *([f"no conclusions: {trouble}"] if trouble else []),
        *results._model_lines(),
        outcome.places(going),
        f"next: results.ranking, or pages by results.report({str(results.folder / 'report')!r})",
    ]
    for line in lines:
        say(line)
