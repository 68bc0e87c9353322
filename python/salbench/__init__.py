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
    from salbench.datasets.dataset import Dataset
    from salbench.models.function import Model, model
    from salbench.runs.cache import Cache
    from salbench.runs.cross_validation import cross_validate
    from salbench.runs.plan import Plan, plan
    from salbench.runs.results import Results
    from salbench.runs.run import run
    from salbench.shapes.gaze import Fixations, Hits, cast_rays, fixations, gaze_density
    from salbench.shapes.scoring import histogram, match_histogram, score
    from salbench.shapes.shape import Shape
    from salbench.shapes.stages import (
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
_HOMES = {"Cache": "runs.cache", "Dataset": "datasets.dataset", "Fixations": "shapes.gaze", "Hits": "shapes.gaze", "Model": "models.function",
          "Plan": "runs.plan", "Results": "runs.results", "Shape": "shapes.shape", "cast_rays": "shapes.gaze", "cross_validate": "runs.cross_validation",
          "fixations": "shapes.gaze", "gaze_density": "shapes.gaze", "histogram": "shapes.scoring", "match_histogram": "shapes.scoring",
          "model": "models.function", "plan": "runs.plan", "run": "runs.run", "score": "shapes.scoring"}  # all others are in shapes.stages


def __getattr__(name: str) -> Any:
    """Names are imported when they are asked for: a listing of a data set costs neither NumPy nor the compiled part."""
    if name in _MODULES:
        return import_module(f"salbench.{name}")
    if name not in __all__:
        raise AttributeError(f"module 'salbench' has no attribute {name!r}")
    value = getattr(import_module(f"salbench.{_HOMES.get(name, 'shapes.stages')}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
