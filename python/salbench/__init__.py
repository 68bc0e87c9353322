# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark of 3D saliency models: metrics, models, descriptors and data sets as functions on NumPy arrays.

    import salbench
    salbench.score(map, ground_truth=truth, picks=picks)     # how well a map predicts what people marked
    salbench.models.ls(points, faces)                        # a published model, of a mesh in memory
    for shape in salbench.Dataset("schelling", "Schelling"):  # a data set as its authors published it
        print(shape.id, shape.points.shape)

All computing is the program's own, with the same bytes: docs/bring_your_model.md.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from salbench._version import __version__

if TYPE_CHECKING:
    from salbench import conclusions, datasets, metrics, models, stats
    from salbench._cache import Cache
    from salbench._data import Dataset
    from salbench._folds import cross_validate
    from salbench._gaze import Fixations, Hits, cast_rays, fixations, gaze_density
    from salbench._plan import Plan, plan
    from salbench._results import Results
    from salbench._run import Model, model, run
    from salbench._scoring import histogram, match_histogram, score
    from salbench._shape import Shape
    from salbench._shapes import (
        CarriedTruth,
        Picture,
        Scan,
        Spectrum,
        carry_ground_truth,
        estimate_normals,
        fpfh,
        partial_mesh,
        picture,
        simplify,
        simulate_scan,
        simulate_scans,
        smooth_picks,
        spectrum,
        vertex_areas,
        vertex_values_of_faces,
        vertex_values_of_samples,
    )

__all__ = [
    "Cache", "CarriedTruth", "Dataset", "Fixations", "Hits", "Model", "Picture", "Plan", "Results", "Scan", "Shape", "Spectrum", "__version__",
    "carry_ground_truth", "cast_rays", "cross_validate", "estimate_normals", "fixations", "fpfh", "gaze_density", "histogram",
    "match_histogram", "metrics", "model", "models", "partial_mesh", "picture", "plan", "run", "score", "simplify", "simulate_scan", "simulate_scans", "smooth_picks", "spectrum", "stats", "vertex_areas",
    "vertex_values_of_faces", "vertex_values_of_samples",
]

_MODULES = ("conclusions", "datasets", "metrics", "models", "stats")
_HOMES = {"Cache": "_cache", "Dataset": "_data", "cross_validate": "_folds", "Fixations": "_gaze", "Hits": "_gaze", "cast_rays": "_gaze",
          "fixations": "_gaze", "gaze_density": "_gaze", "Plan": "_plan", "plan": "_plan", "Results": "_results", "Model": "_run", "model": "_run",
          "run": "_run", "histogram": "_scoring", "match_histogram": "_scoring", "score": "_scoring", "Shape": "_shape"}  # all others are in _shapes


def __getattr__(name: str) -> Any:
    """Names are imported when they are asked for: a listing of a data set costs neither NumPy nor the compiled part."""
    if name in _MODULES:
        return import_module(f"salbench.{name}")
    if name not in __all__:
        raise AttributeError(f"module 'salbench' has no attribute {name!r}")
    value = getattr(import_module(f"salbench.{_HOMES.get(name, '_shapes')}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
