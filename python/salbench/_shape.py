# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh, a scan or a point cloud, with what is known about it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from salbench._show import View, show
from salbench._types import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape of n points and m faces. Its arrays are read-only; what is not known, or was not asked for, is None.

    Attributes
    ----------
    id : str
        "52", or "52_3" for scan 3 of mesh 52.
    points : (n, 3) array
        Positions, in the unit of the file.
    faces : (m, 3) array of int32
        Corners, as numbers of points; of a scan or point cloud the partial mesh.
    normals : (n, 3) array
        Unit normals.
    fpfh : (n, 33) array of float32
        Descriptors. [rusu2009]
    category : str
        Class of the shape, or "".
    split : str
        Split that the data set has it in, or "".
    ground_truth : (n,) array
        Saliency; NaN where nobody looked.
    participants : list of (p,) arrays of int32
        What each of them marked, in the order of the file.
    viewers : list of (n,) arrays
        Saliency by viewer.
    source : str
        Path of the file that it was read from, with what lies beside it, such as textures; of a scan that of its mesh. Only where a
        `Model` reads "source".
    """

    id: str
    points: NDArray[np.float64]
    faces: NDArray[np.int32] | None = None
    normals: NDArray[np.float64] | None = None
    fpfh: NDArray[np.float32] | None = None
    category: str = ""
    split: str = ""
    ground_truth: NDArray[np.float64] | None = None
    participants: tuple[NDArray[np.int32], ...] = ()
    viewers: tuple[NDArray[np.float64], ...] = ()
    source: str | None = None

    @property
    def picks(self) -> NDArray[np.int32]:
        """The points that anybody marked, ascending, each as often as it was."""
        if not self.participants:
            return np.empty(0, np.int32)
        return np.sort(np.concatenate(self.participants))

    @property
    def mask(self) -> NDArray[np.bool_]:
        """Points that somebody looked at: those that a score counts."""
        if self.ground_truth is None:
            return np.ones(len(self.points), bool)
        return ~np.isnan(self.ground_truth)

    def show(self, values: ArrayLike | Mapping[str, ArrayLike] | None = None) -> View:
        """The shape in the viewer of the report, as an object that a notebook shows and whose `str()` is a page of HTML.

        Parameters
        ----------
        values : (n,) array, or dict of them by name, optional
            Maps to be painted on it, beside the ground truth: each from its lowest to its highest value.

        Raises
        ------
        ValueError
            Values that do not fit the points.
        FileNotFoundError
            Without three.js: Debian's package libjs-three.
        """
        return show(self, values)

    def _repr_html_(self) -> str | None:
        try:
            return self.show()._repr_html_()
        except (FileNotFoundError, ValueError):  # without three.js, or points
            return None

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        faces = "no faces" if self.faces is None else f"{len(self.faces)} faces"
        return f"Shape({self.id!r}, {len(self.points)} points, {faces})"
