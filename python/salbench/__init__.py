# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark of 3D saliency models: metrics, models, descriptors and data sets as functions on NumPy arrays.

    import salbench
    salbench.score(prediction, ground_truth, picks)          # how well a map predicts what people marked
    salbench.models.ls(points, faces)                        # a published model, of a mesh in memory
    for shape in salbench.Dataset("schelling", "Schelling"):  # a data set as its authors published it
        print(shape.id, shape.points.shape)

All computing is the program's own, with the same bytes: docs/python.md.
"""

from salbench import metrics, models, stats
from salbench._cache import Cache
from salbench._core import version as __version__
from salbench._data import Dataset
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
    "Cache", "CarriedTruth", "Dataset", "Model", "Picture", "Results", "Scan", "Shape", "Spectrum", "__version__", "carry_ground_truth",
    "estimate_normals", "fpfh", "histogram", "match_histogram", "metrics", "model", "models", "partial_mesh", "picture", "run",
    "score", "simplify", "simulate_scan", "simulate_scans", "smooth_picks", "spectrum", "stats", "vertex_areas",
    "vertex_values_of_faces", "vertex_values_of_samples",
]
