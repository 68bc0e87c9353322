# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark of 3D saliency models: metrics, models, descriptors and data sets as functions on NumPy arrays.

    import salbench
    salbench.score(prediction, ground_truth, picks)          # how well a map predicts what people marked
    salbench.models.ls(points, faces)                        # a published model, of a mesh in memory
    for shape in salbench.Dataset("schelling", "Schelling"):  # a data set as its authors published it
        print(shape.id, shape.points.shape)

All computing is the program's own, with the same bytes: docs/python.md.
"""

from salbench import metrics
from salbench._cache import Cache
from salbench._core import version as __version__
from salbench._data import Dataset
from salbench._results import Results
from salbench._run import Model, model, run
from salbench._scoring import histogram, match_histogram, score
from salbench._shape import Shape

__all__ = ["Cache", "Dataset", "Model", "Results", "Shape", "__version__", "histogram", "match_histogram", "metrics", "model", "run", "score"]
