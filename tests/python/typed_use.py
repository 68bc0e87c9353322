# SPDX-License-Identifier: GPL-3.0-or-later
"""A user's program, for mypy (docstrings_test.py). Its last line has the only error."""

import numpy as np
from numpy.typing import NDArray

import salbench


def predict(shape: salbench.Shape) -> NDArray[np.float64]:
    return salbench.models.ls(shape.points, shape.faces, foci_share=0.1)


scores: dict[str, float] = salbench.score([0.0, 1.0], [0, 1], picks=[1], splits=10)
value: float = salbench.metrics.auc_exact(np.zeros(3), picks=[0])
results = salbench.run({"dataset": {"scans": False}}, data="meshes", models={"MINE": predict, "LS": {}})
table = results.ranking
values: NDArray[np.float64] = results.maps("MINE")["52"]
folds = salbench.cross_validate(lambda shapes: predict, "meshes", by="mesh", models={"LS": {}, "MINE": predict}).trained["FIT"]


if __name__ == "__main__":
    salbench.run(threads="2")
