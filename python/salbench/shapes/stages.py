# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages that process shapes: normals, descriptors, scans, surfaces, pictures.

Docstrings describe arguments of a single function; `documented` adds shared arguments and options.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from salbench import _core
from salbench.shapes.options import Value, documented
from salbench.system.types import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Scan:
    """A simulated range image of a mesh as a set of points.

    Attributes
    ----------
    points : (n, 3) array
        In the coordinates of the mesh, row by row of the grid of rays.
    camera : (3,) array
        Centre of projection.
    """

    points: NDArray[np.float64]
    camera: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"Scan({len(self.points)} points)"


class Spectrum(NamedTuple):
    """Eigenpairs: `values` (k,), ascending, in 1 / R^2; `vectors` (n, k), orthonormal columns of arbitrary
    sign."""

    values: NDArray[np.float64]
    vectors: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Picture:
    """Geometry behind each pixel of a picture, without colours; the top row first.

    Attributes
    ----------
    primitive : (size, size) array of int32
        Face of a mesh, or point of a scan or point cloud; -1 for the background.
    weights : (size, size, 3) array of float32
        Weights of the face's corners, sum 1; 1, 0, 0 for a point.
    depth : (size, size) array of float32
        Depth along the viewing direction, in the unit of the points; infinite for the background.
    shade : (size, size) array of uint8
        Brightness of a white surface; 255 for the background.
    coverage : (size, size) array of uint8
        Part of the pixel that the shape covers; 255 is all of it.
    view_projection : (4, 4) array
        World to clip space, for column vectors.
    """

    primitive: NDArray[np.int32]
    weights: NDArray[np.float32]
    depth: NDArray[np.float32]
    shade: NDArray[np.uint8]
    coverage: NDArray[np.uint8]
    view_projection: NDArray[np.float64]


@documented
def estimate_normals(
    points: ArrayLike,
    faces: ArrayLike | None = None,
    *,
    viewpoint: ArrayLike | None = None,
    threads: int | None = 1,
    **options: Value,
) -> NDArray[np.float64]:
    """Estimates unit normals of a mesh, a scan or a point cloud.

    Normals of a mesh point outward. Without faces, they are normals of planes through the neighbours,
    oriented towards the viewpoint or, without one, outward.

    Parameters
    ----------
    faces : (m, 3) array of int, optional
        Corners, counter-clockwise seen from outside.
    viewpoint : (3,) array, optional
        For points without faces: position of the camera, such as `Scan.camera`.
    **options
        For a mesh, as in the section `normals` of a configuration:

        **mesh_normals

        For points, as in the section `scan_normals`:

        **cloud_normals

    Returns
    -------
    (n, 3) array

    Raises
    ------
    ValueError
        An invalid argument, or a mesh without area.

    References
    ----------
    [hoppe1992]

    Examples
    --------
    >>> import salbench
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> salbench.estimate_normals(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])[0].round(3).tolist()
    [-0.577, -0.577, -0.577]
    """
    if faces is None:
        return _core.cloud_normals(points, viewpoint, threads, options)
    if viewpoint is not None:
        raise ValueError("viewpoint must be None for a mesh: its faces say what is outside")
    return _core.mesh_normals(points, faces, threads, options)


@documented
def fpfh(
    points: ArrayLike, normals: ArrayLike, *, scan: bool = False, threads: int | None = 1, **options: Value
) -> NDArray[np.float32]:
    """Computes fast point feature histograms, the descriptors that several models share.

    Parameters
    ----------
    scan : bool
        True: defaults of the section `scan_fpfh` of a configuration: neighbourhood radius, grown_neighbours
        12.

    Returns
    -------
    (n, 33) array of float32
        Three features of 11 bins: theta, alpha, phi.

    References
    ----------
    [rusu2009], [tasse2016]

    Examples
    --------
    >>> import numpy as np
    >>> import salbench
    >>> plane = np.stack([*np.mgrid[:5, :5], np.zeros((5, 5))], axis=-1).reshape(-1, 3)
    >>> descriptors = salbench.fpfh(plane, np.tile([0, 0, 1], (25, 1)))
    >>> descriptors.shape, np.flatnonzero(descriptors[12]).tolist()
    ((25, 33), [5, 16, 27])
    """
    return (_core.scan_fpfh if scan else _core.fpfh)(points, normals, threads, options)


@documented
def simulate_scan(points: ArrayLike, faces: ArrayLike, view: int, **options: Value) -> Scan:
    """Simulates the range scan of a mesh by a depth camera at one of the 12 corners of an icosahedron.

    Parameters
    ----------
    faces : (m, 3) array of int
        Corners; both sides are seen.
    view : int
        0 to 11.

    Returns
    -------
    Scan
        Points on the faces, and the camera.

    Raises
    ------
    ValueError
        An invalid argument, or a mesh without area.

    References
    ----------
    [tasse2016]

    Examples
    --------
    >>> import salbench
    >>> scan = salbench.simulate_scan([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 1, step_degrees=2)
    >>> len(scan) > 0, float(abs(scan.points[:, 2]).max()), scan.camera.shape
    (True, 0.0, (3,))
    """
    return Scan(*_core.simulate_scan(points, faces, view, options))


@documented
def simulate_scans(
    points: ArrayLike, faces: ArrayLike, *, threads: int | None = 1, **options: Value
) -> tuple[Scan, ...]:
    """Simulates all 12 scans of a mesh, faster than one by one.

    Parameters
    ----------
    faces : (m, 3) array of int
        Corners; both sides are seen.

    Returns
    -------
    tuple of Scan
        Views 0 to 11.

    Raises
    ------
    ValueError
        An invalid argument, or a mesh without area.

    References
    ----------
    [tasse2016]

    Examples
    --------
    >>> import salbench
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> len(salbench.simulate_scans(corners, faces, step_degrees=2))
    12
    """
    return tuple(Scan(*scan) for scan in _core.simulate_scans(points, faces, threads, options))


@documented
def partial_mesh(points: ArrayLike, normals: ArrayLike, **options: Value) -> NDArray[np.int32]:
    """Triangulates the points of a scan or a point cloud by greedy projection.

    Returns
    -------
    (m, 3) array of int32
        Faces, counter-clockwise seen from the side that the normals point to. There may be holes.

    References
    ----------
    [marton2009]

    Examples
    --------
    >>> import numpy as np
    >>> import salbench
    >>> plane = np.stack([*np.mgrid[:3, :3], np.zeros((3, 3))], axis=-1).reshape(-1, 3)
    >>> len(salbench.partial_mesh(plane, np.tile([0, 0, 1], (9, 1))))
    8
    """
    return _core.partial_mesh(points, normals, options)


@documented
def simplify(
    points: ArrayLike, faces: ArrayLike, target_faces: int
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Simplifies a mesh by collapsing edges in the order of their quadric error.

    Parameters
    ----------
    faces : (m, 3) array of int
        Corners of any triangle soup.
    target_faces : int
        Maximum number of faces; exceeded if every further collapse would change the topology or fold a face
        over.

    Returns
    -------
    points : (k, 3) array
    faces : (l, 3) array of int32
        Without duplicate and degenerate faces, and without unused points.

    References
    ----------
    [garland1997]

    Examples
    --------
    >>> import salbench
    >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]]
    >>> points, faces = salbench.simplify(corners, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], 2)
    >>> points.shape, faces.shape
    ((4, 3), (2, 3))
    """
    return _core.simplify(points, faces, target_faces)


@documented
def vertex_areas(points: ArrayLike, faces: ArrayLike) -> NDArray[np.float64]:
    """Area of each point of a surface: a third of the area of the faces around it. The sum is the area of the
    surface.

    Returns
    -------
    (n,) array
        In squared units; 0 for points without faces.

    Examples
    --------
    >>> import salbench
    >>> salbench.vertex_areas([[0, 0, 0], [6, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]]).tolist()
    [1.0, 1.0, 1.0, 0.0]
    """
    return _core.vertex_areas(points, faces)


@documented
def spectrum(points: ArrayLike, faces: ArrayLike, k: int) -> Spectrum:
    """The lowest eigenpairs of the graph Laplacian whose edges weigh 1 / distance^2, as in the model MS.

    MS itself uses the largest component of the surface, simplified.

    Parameters
    ----------
    faces : (m, 3) array of int
        Corners; they connect all points.
    k : int
        Number of eigenpairs, 2 to n - 2; eigenvalues count with their multiplicity.

    Returns
    -------
    Spectrum
        values : (k,) array, ascending, in 1 / R^2; R is the largest distance of a point to the centroid.
        vectors : (n, k) array, orthonormal columns, each of arbitrary sign; the first is constant.

    Raises
    ------
    ValueError
        An invalid argument, or points that the faces do not connect.

    References
    ----------
    [song2014]

    Examples
    --------
    >>> import salbench
    >>> corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
    >>> faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    >>> salbench.spectrum(corners, faces, 4).values.round(9).tolist()
    [0.0, 2.0, 2.0, 2.0]
    """
    return Spectrum(*_core.spectrum(points, faces, k))


@documented
def picture(
    points: ArrayLike,
    faces: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    *,
    viewpoint: ArrayLike | None = None,
    seed: int = 0,
    item: str = "",
    threads: int | None = 1,
    **options: Value,
) -> Picture:
    """Renders a shape to the geometry behind each pixel, so that any map is painted by looking up values.

    Parameters
    ----------
    faces : (m, 3) array of int, optional
        Faces of a mesh, or the partial mesh of points with normals; default: computed as by `partial_mesh`.
    normals : (n, 3) array, optional
        Unit normals of a scan or a point cloud.
    viewpoint : (3,) array, optional
        Viewpoint of the points: the camera is placed near it.

    Returns
    -------
    Picture

    Raises
    ------
    ValueError
        An invalid argument, or nothing visible.

    Examples
    --------
    >>> import salbench
    >>> seen = salbench.picture([[0, 0, 0], [1, 0, 0], [0, 0, 1]], [[0, 1, 2]], size=16)
    >>> seen.primitive.shape, sorted(set(seen.primitive.ravel().tolist()))
    ((16, 16), [-1, 0])
    """
    return Picture(*_core.picture(points, faces, normals, viewpoint, seed, str(item), threads, options))
