# SPDX-License-Identifier: GPL-3.0-or-later
"""Published models as functions of a shape, under the names of the program's table in lower case: ls, cs, ps,
ms, ...

Each takes a mesh, a scan or a point cloud, and options named as in a configuration. Missing inputs are
computed as in a run: normals, descriptors, the partial mesh. The option `faces` of a configuration, the
number of faces that a larger mesh is simplified to, is called `target_faces` here, as in `salbench.simplify`.

>>> import numpy as np
>>> from salbench import models
>>> points = np.random.default_rng(1).normal(size=(200, 3))
>>> models.ls(points, foci_share=0.1).shape
(200,)
"""

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from salbench import _core
from salbench.shapes.options import Row, Value, documented
from salbench.shapes.shape import Shape, known_normals
from salbench.shapes.stages import Scan
from salbench.system.names import Rows
from salbench.system.types import ArrayLike, NDArray


class ModelFunction(Protocol):
    """Signature of the functions of this module."""

    def __call__(
        self,
        points: ArrayLike | Shape | Scan,
        faces: ArrayLike | None = None,
        normals: ArrayLike | None = None,
        fpfh: ArrayLike | None = None,
        *,
        scan: bool = False,
        seed: int = 0,
        item: str = "",
        threads: int | None = 1,
        **options: Value,
    ) -> NDArray[np.float64]:
        ...


class ModelRow(NamedTuple):
    """A row of the table of models."""

    name: str
    reads: list[str]
    random: bool
    is_reference: bool
    options: list[Row]


def table() -> Rows[ModelRow]:
    """Returns the models that make maps, in the order of the program: a list, whose `frame()` is a data
    frame.

    Returns
    -------
    list of (name, reads, random, is_reference, options)
        `reads` names arguments; `options` are (name, default, note).

    Examples
    --------
    >>> from salbench import models
    >>> [row.reads for row in models.table() if row.name == "LS"]
    [['points', 'normals', 'fpfh']]
    """
    return Rows(ModelRow(*row) for row in _core.model_table())


_RENAMED = {"faces": "target_faces"}  # options that share the name of an argument

_DOCUMENTATION = """{summary}

Parameters
----------
points : (n, 3) array, `Shape` or `Scan`
    Positions, in any unit; or a shape, which supplies the arguments that are not given.
faces : (m, 3) array of int, optional
    Corners of a mesh, or the partial mesh of a scan or point cloud.
normals : (n, 3) array, optional
    Unit normals.
fpfh : (n, 33) array, optional
    Descriptors from `salbench.fpfh`.
scan : bool
    True: options and descriptors of scans, which may differ from those of meshes and point clouds.

Returns
-------
(n,) array
    The map as the model made it; metrics normalise it.

Raises
------
ValueError
    An invalid argument, or a shape that the model cannot handle.

Notes
-----
Reads {reads}. Missing inputs are computed with the default options of a run. Normals of a mesh come from its faces,
those of a `Scan` are oriented towards its camera, and those of other points outward.
{references}
Examples
--------
>>> import numpy as np
>>> from salbench import models
>>> models.{function}(np.random.default_rng(1).normal(size=(50, 3))).shape
(50,)
"""


def _function(row: ModelRow) -> ModelFunction:
    name = row.name.lower().replace("-", "_")
    taken = {_RENAMED[option]: option for option, _, _ in row.options if option in _RENAMED}
    rows = [(_RENAMED.get(option, option), default, note) for option, default, note in row.options]

    def model(
        points: ArrayLike | Shape | Scan,
        faces: ArrayLike | None = None,
        normals: ArrayLike | None = None,
        fpfh: ArrayLike | None = None,
        *,
        scan: bool = False,
        seed: int = 0,
        item: str = "",
        threads: int | None = 1,
        **options: Value,
    ) -> NDArray[np.float64]:
        camera: Any = None
        if isinstance(points, Shape):
            shape = points
            points = shape.points
            faces = shape.faces if faces is None else faces
            normals = known_normals(shape) if normals is None else normals
            fpfh = shape.fpfh if fpfh is None else fpfh
            item = item or shape.id
        elif isinstance(points, Scan):
            camera, scan = points.camera, True
            points = points.points
        written = {taken.get(key, key): value for key, value in options.items()}
        return _core.map(
            row.name,
            name,
            points,
            faces,
            normals,
            fpfh,
            camera,
            bool(scan),
            seed,
            str(item),
            threads,
            written,
        )

    model.__name__ = model.__qualname__ = name
    about = _core.models_about[row.name]
    references = f"\nReferences\n----------\n[{about.key}]\n" if about.key else ""
    reads = ", ".join(f"`{part}`" for part in row.reads) + (", and random numbers" if row.random else "")
    model.__doc__ = _DOCUMENTATION.format(
        summary=about.summary, function=name, reads=reads, references=references
    )
    return documented(model, rows)


_functions = {function.__name__: function for function in map(_function, table())}  # type: ignore[attr-defined]
globals().update(_functions)
__all__ = ["ModelFunction", "table", *_functions]


def __dir__() -> list[str]:
    return sorted(__all__)


if TYPE_CHECKING:

    def __getattr__(name: str) -> ModelFunction:
        ...
