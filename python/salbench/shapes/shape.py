# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh, a scan or a point cloud, with its ground truth and other properties."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from salbench.shapes.show import View, show
from salbench.shapes.stages import estimate_normals
from salbench.system.types import ArrayLike, NDArray


# Names, types and shapes. None: the number of points; -1: any number.
_ARRAYS: tuple[tuple[str, Any, tuple[int | None, ...]], ...] = (
    ("points", np.float64, (None, 3)),
    ("normals", np.float64, (None, 3)),
    ("fpfh", np.float32, (None, 33)),
    ("ground_truth", np.float64, (None,)),
    ("faces", np.int32, (-1, 3)),
)
_BY_PERSON: tuple[tuple[str, Any, tuple[int | None, ...]], ...] = (
    ("participants", np.int32, (-1,)),
    ("viewers", np.float64, (None,)),
)


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape of n points and m faces. Its arrays are read-only; unknown ones, and those not requested, are
    None.

    Arguments are checked: a ValueError names an invalid one.

    Attributes
    ----------
    id : str
        "52", or "52_3" for scan 3 of mesh 52.
    points : (n, 3) array
        Positions, in the unit of the file.
    faces : (m, 3) array of int32
        Corners, as numbers of points; for a scan or point cloud, the partial mesh.
    normals : (n, 3) array
        Unit normals. Shapes of a `Dataset` without normals in the file estimate them on first access.
    fpfh : (n, 33) array of float32
        Descriptors. [rusu2009]
    category : str
        Class of the shape, or "".
    split : str
        Split of the shape in the data set, or "".
    ground_truth : (n,) array
        Saliency; NaN for points that nobody looked at.
    participants : list of (p,) arrays of int32
        Points that each participant marked, in the order of the file.
    viewers : list of (n,) arrays
        Saliency by viewer.
    source : str
        Path of the shape's file, with neighbours such as textures; for a scan, that of its mesh. Only if a
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

    def __post_init__(self) -> None:
        n = len(self.points) if hasattr(self.points, "__len__") else 0
        for name, type, shape in _ARRAYS:
            if (given := self.__dict__[name]) is not None or name == "points":
                object.__setattr__(self, name, _checked(name, given, type, shape, n))
        for name, type, shape in _BY_PERSON:
            object.__setattr__(
                self, name, tuple(_checked(name, given, type, shape, n) for given in getattr(self, name))
            )

    @property
    def picks(self) -> NDArray[np.int32]:
        """Points that anybody marked, ascending, repeated for each mark."""
        if not self.participants:
            return np.empty(0, np.int32)
        return np.sort(np.concatenate(self.participants))

    @property
    def mask(self) -> NDArray[np.bool_]:
        """Points that somebody looked at, which scores are restricted to."""
        if self.ground_truth is None:
            return np.ones(len(self.points), bool)
        return ~np.isnan(self.ground_truth)

    def show(self, values: ArrayLike | Mapping[str, ArrayLike] | None = None) -> View:
        """Returns the shape in the report's viewer: an object that notebooks display and whose `str()` is an
        HTML page.

        Parameters
        ----------
        values : (n,) array, or dict of them by name, optional
            Maps to paint, beside the ground truth, each scaled from its lowest to its highest value.

        Raises
        ------
        ValueError
            Values whose number differs from that of the points.
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


# outside the shapes, so that functions depending on a shape see no change
_ESTIMATED: "WeakKeyDictionary[Shape, NDArray[np.float64]]" = WeakKeyDictionary()


class Read(Shape):
    """A shape from a data set, which estimates normals on access if its file has none."""

    _viewpoint: ClassVar[NDArray[np.float64] | None] = None

    @property
    def normals(self) -> NDArray[np.float64]:
        known = known_normals(self)
        if known is None and self not in _ESTIMATED:
            _ESTIMATED[self] = estimate_normals(self.points, self.faces, viewpoint=self._viewpoint)
        return _ESTIMATED[self] if known is None else known

    @normals.setter
    def normals(self, given: NDArray[np.float64] | None) -> None:
        self.__dict__["normals"] = given


def set_viewpoint(cloud: Read, viewpoint: NDArray[np.float64] | None) -> None:
    """Sets where a cloud was seen from, if known: its estimated normals point there, as in a run."""
    if viewpoint is not None:
        cloud.__dict__["_viewpoint"] = viewpoint


def known_normals(shape: Shape) -> NDArray[np.float64] | None:
    """Normals that a shape was given."""
    normals: NDArray[np.float64] | None = shape.__dict__["normals"]
    return normals


def _checked(name: str, given: Any, type: Any, form: tuple[int | None, ...], n: int) -> NDArray[Any]:
    """Converts to a read-only array of a type and form; numbers of points from 0 to n - 1, all others finite
    except for unknown ground truth."""
    shape = tuple(n if wanted is None else wanted for wanted in form)
    try:
        values = np.asarray(given)
        if values.dtype.kind not in "biuf" or (
            type is np.int32 and values.size and values.dtype.kind not in "iu"
        ):
            advice = ": write .astype(int)" if type is np.int32 and values.dtype.kind == "f" else ""
            raise ValueError(f"has values of type {values.dtype}{advice}")
        if values.ndim != len(shape) or any(
            wanted not in (-1, found) for wanted, found in zip(shape, values.shape)
        ):
            raise ValueError(f"must have shape {shape}, not {values.shape}".replace("-1", "any"))
        if values.shape[0] > np.iinfo(np.int32).max:
            raise ValueError("has more than 2^31 rows")
        if type is np.int32 and values.size and not 0 <= values.min() <= values.max() < n:
            raise ValueError(f"must have numbers of points, 0 to {n - 1}")
        if (
            type is not np.int32
            and (np.isinf(values) if name in ("ground_truth", "viewers") else ~np.isfinite(values)).any()
        ):
            raise ValueError("must be finite")
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}") from None
    view = values.astype(type, copy=False).view()
    view.flags.writeable = False
    return view
