# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark of 3D saliency models: metrics, models, descriptors and data sets as functions on NumPy arrays.

    import salbench
    salbench.score(map, ground_truth=truth, picks=picks)      # agreement of a map with people's marks
    salbench.models.ls(points, faces)                         # a published model, on a mesh in memory
    for shape in salbench.Dataset("schelling", "Schelling"):  # a data set as its authors published it
        print(shape.id, shape.points.shape)

All results equal the program's to the byte: docs/bring_your_model.md.
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
    from salbench.shapes.ground_truth import (
        CarriedTruth,
        carry_ground_truth,
        smooth_picks,
        vertex_values_of_faces,
        vertex_values_of_samples,
    )
    from salbench.shapes.scoring import histogram, match_histogram, score
    from salbench.shapes.shape import Shape
    from salbench.shapes.stages import (
        Picture,
        Scan,
        Spectrum,
        estimate_normals,
        fpfh,
        partial_mesh,
        picture,
        simplify,
        simulate_scan,
        simulate_scans,
        spectrum,
        vertex_areas,
    )

__all__ = [
    "Cache",
    "CarriedTruth",
    "Dataset",
    "Fixations",
    "Hits",
    "Model",
    "Picture",
    "Plan",
    "Results",
    "Scan",
    "Shape",
    "Spectrum",
    "__version__",
    "carry_ground_truth",
    "cast_rays",
    "cross_validate",
    "estimate_normals",
    "fixations",
    "fpfh",
    "gaze_density",
    "histogram",
    "match_histogram",
    "metrics",
    "model",
    "models",
    "partial_mesh",
    "picture",
    "plan",
    "run",
    "score",
    "simplify",
    "simulate_scan",
    "simulate_scans",
    "smooth_picks",
    "spectrum",
    "stats",
    "vertex_areas",
    "vertex_values_of_faces",
    "vertex_values_of_samples",
]

_MODULES = ("conclusions", "datasets", "metrics", "models", "stats")
_HOMES = {
    name: home
    for home, names in {
        "datasets.dataset": ("Dataset",),
        "models.function": ("Model", "model"),
        "runs.cache": ("Cache",),
        "runs.cross_validation": ("cross_validate",),
        "runs.plan": ("Plan", "plan"),
        "runs.results": ("Results",),
        "runs.run": ("run",),
        "shapes.gaze": ("Fixations", "Hits", "cast_rays", "fixations", "gaze_density"),
        "shapes.ground_truth": (
            "CarriedTruth",
            "carry_ground_truth",
            "smooth_picks",
            "vertex_values_of_faces",
            "vertex_values_of_samples",
        ),
        "shapes.scoring": ("histogram", "match_histogram", "score"),
        "shapes.shape": ("Shape",),
        "shapes.stages": (
            "Picture",
            "Scan",
            "Spectrum",
            "estimate_normals",
            "fpfh",
            "partial_mesh",
            "picture",
            "simplify",
            "simulate_scan",
            "simulate_scans",
            "spectrum",
            "vertex_areas",
        ),
    }.items()
    for name in names
}


def __getattr__(name: str) -> Any:
    """Imports names on access: listing a data set loads neither NumPy nor the compiled part."""
    if name in _MODULES:
        return import_module(f"salbench.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'salbench' has no attribute {name!r}")
    value = getattr(import_module(f"salbench.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES})
