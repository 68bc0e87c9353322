# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation: trained models, each scored on shapes that it has not seen."""

import dataclasses
import logging
import os
import pathlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, cast, overload

from salbench import _core, datasets
from salbench.datasets.dataset import Dataset
from salbench.models.function import Model, Predict
from salbench.runs.folds import dealt, in_split, with_scans
from salbench.runs.learning import Fit, Learner, Training, TrainingShapes, learned_model, write_costs
from salbench.runs.results import Results
from salbench.runs.run import carry_out
from salbench.runs.settings import Settings, settings_of
from salbench.system.files import path_of, replace_file
from salbench.system.types import ArrayLike

if TYPE_CHECKING:
    from salbench.runs.plan import Plan


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
) -> Results:
    ...


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
) -> "Plan":
    ...


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
) -> "Results | Plan":
    """Trains and scores models that learn, each shape by a model that saw neither it nor, by class, any shape
    of its class.

    The shapes with ground truth are divided into folds. For each fold, `fit` gets the shapes of all others,
    and the function that it returns makes the maps of the fold. Training shapes are held in memory. Maps are
    cached by the dependencies of `fit`, as described for `Model`, and by the contents of its training shapes:
    a fold is trained only if one of its maps is missing.

    Parameters
    ----------
    fit : callable, or dict of them by name
        Takes a list of `Shape` with ground truth, returns a function of a `Shape` without it, as for `run`.
        It must be deterministic: fix its seeds. A parameter `fold`, if it has one, gets the number of the
        fold, from 0. Without a name it is called MINE in the tables. As a `Model` it has version, depends,
        reads and cache as there. Scans are not among the shapes: `simulate_scans` and `carry_ground_truth`
        make them.
    data : path
        Folder of the data set.
    config : str, path or dict, optional
        As of `run`. The defaults of its options hold for the normals and descriptors of the training shapes.
    folds : int
        Number of folds, at most one per class, or per mesh.
    by : str
        "class": shapes of a class stay together. "mesh": views and scans of a mesh stay together. "split":
        the data set's own splits, one model for all: it is scored on `split` and trained on all other splits;
        `Shape.split` tells them apart.
    split : str
        The split that is scored if `by` is "split".
    seed : int
        Folds depend only on it and on the names of classes or meshes, so they are the same on every machine.
    models : dict, optional
        Further models in the same tables, as of `run`: functions, or models of the program, such as {"LS":
        {}}. Default: those of the configuration.
    keep : path, optional
        Folder of trained models, one file per fold in a folder named by the model, stored right after its
        training: existing folds are loaded, not trained again. Functions within functions, lambdas and code
        of your own modules are stored with it (cloudpickle). If a model cannot be stored, one warning says
        so, and its maps are made anyway. Loading runs code: use only your own files.
    cache, out, reference, threads, progress
        As of `run`.
    keep_going : bool
        As of `run`; also trains folds after the first two have failed alike.
    plan : bool
        True: trains, computes and writes nothing, calls none of your functions, and returns a `Plan` as the
        function `plan` does, whose `folds` lists by model the folds that would be trained.

    Returns
    -------
    Results, or Plan
        `models` has, by name, the numbers of folds that this call trained ("trained") and whose training
        failed ("failed"), `folds` a row per fold and item with its role, scored or trained on, and `training`
        the seconds of each training. `write_submission` writes what others need to reproduce the maps.

    Raises
    ------
    KeyError
        An unknown split.
    ValueError
        Impossible folds, ground truth from gaze with options that a `Dataset` does not use, and as of `run`.

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
    settings = settings_of(
        config, data, models, cache, out, "scored", split if by == "split" else "", reference, keep_going
    )
    protocol = settings.protocol()
    options = protocol["dataset"]
    if options["participants"] == "simulated":
        raise ValueError("participants are simulated: there is no ground truth to train on")
    for one in fits.values():
        if not callable(one) and not isinstance(one, Model):
            raise ValueError(f"fit must be a function of a list of shapes, not {one!r:.100}")
    if by != "split" and options["split"]:
        logging.getLogger("salbench").warning(
            (
                "the configuration's split %s takes no part: folds by %s are dealt out over all shapes with"
                " ground truth; by='split' trains on all splits but one"
            ),
            options["split"],
            by,
        )
    dataset = (
        Dataset(data, items="scored")
        if isinstance(data, datasets.Dataset)
        else Dataset(options["layout"], data, items="scored")
    )
    _require_same_truth(dataset, protocol)
    dealing = in_split(dataset._items, split) if by == "split" else dealt(dataset._items, folds, by, seed)
    if options["scans"]:
        dealing = with_scans(dealing)
    shapes = TrainingShapes(dataset, {name for names in dealing.training for name in names})
    how = Training(None if keep is None else pathlib.Path(path_of(keep, "keep")), progress, keep_going)
    learned = {
        name: learned_model(
            name, one if isinstance(one, Model) else Model(cast(Predict, one)), dealing, shapes, how
        )
        for name, one in fits.items()
    }
    settings = dataclasses.replace(settings, functions={**learned, **settings.functions})
    if plan:
        from salbench.runs.plan import Plan, planned

        found, open_shapes = planned(settings)
        return Plan(
            found,
            {
                name: cast(Learner, model.predict).to_train(open_shapes[name])
                for name, model in learned.items()
            },
        )
    learners = {name: cast(Learner, model.predict) for name, model in learned.items()}

    def write_tables(folder: pathlib.Path) -> None:
        replace_file(
            folder / "folds.csv", dealing.of(shapes.digests).csv().encode("utf-8", "surrogateescape")
        )
        write_costs(folder / "training.csv", learners.values())

    results = carry_out(settings, threads, progress, write_tables)
    results._learners = learners
    results._warn_of_failed()
    return results


def _require_same_truth(dataset: Dataset, protocol: Mapping[str, Any]) -> None:
    """Throws ValueError if maps would be scored against other ground truth than that of a Dataset: from
    files, or else from gaze with default options."""
    recorded = protocol["dataset"]["participants"] == "recorded"
    other_gaze = protocol["gaze"] != Settings(yaml="{}").protocol()["gaze"]
    for item in dataset._items:
        if item.recorded and (recorded and item.truth or other_gaze and (recorded or not item.truth)):
            raise ValueError(
                f"{item.name}: is scored against another ground truth of gaze than models would be trained"
                " on, since `gaze` or `participants` of the configuration are not the defaults: write that"
                " ground truth into a separate data set with salbench.datasets.write, and cross-validate on"
                " that"
            )
