# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of exports (salbench export, HDF5): points, faces, maps, picks and pictures, read on access."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy
from numpy.typing import NDArray

from salbench.conclusions.units import Floats
from salbench.pages.names import KIND_NAMES
from salbench.pages.viewer_parts import unit_range
from salbench.report.names import natural, shape_name
from salbench.system.errors import InputError
from salbench.system.files import require_file

Faces = NDArray[numpy.int32]
Maps = dict[tuple[str, str], Floats]  # (model, when) -> values
# kind of a stage -> position of its maps: before or after histogram matching
KINDS = {"map": "before", "matched": "after"}
# exceptions of h5py for damaged or foreign files
BROKEN = (KeyError, OSError, ValueError, RuntimeError, TypeError)


def text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


@dataclass
class Picture:
    """A picture by a pinhole camera; row 0 is the top row."""

    primitive: Faces  # H x W int32: face of a mesh, point of other shapes; -1: background
    weights: NDArray[Any]  # H x W x 3 float32: of the face's corners; 1, 0, 0 for points
    shade: NDArray[numpy.uint8]  # H x W uint8: brightness
    view_projection: Floats  # 4 x 4 float64: world to clip space, column vectors
    depth: NDArray[Any]  # H x W float32: along the viewing direction, the w of clip space
    coverage: NDArray[numpy.uint8]  # H x W uint8: fraction of the pixel that the shape covers

    def camera(self) -> tuple[Floats | None, str]:
        """Position of the camera in the coordinates of the shape, None at infinity, and the axis that points
        up in the picture, "y" or "z"."""
        rows = self.view_projection[[0, 1, 3]]
        eye = numpy.linalg.svd(rows)[2][-1]  # the only point without an image
        return eye[:3] / eye[3] if abs(eye[3]) > 1e-12 else None, (
            "z" if abs(rows[1, 2]) > abs(rows[1, 1]) else "y"
        )


@dataclass(frozen=True)
class Places:
    """Paths of the common data sets within the groups of one kind of shapes."""

    points: str
    ground_truth: str
    faces: str = ""  # empty: no faces
    normals: str = ""
    eye: str = ""  # viewpoint of the points


PLACES = {
    "meshes": Places("mesh/vertices", "ground_truth", faces="mesh/faces"),
    "scans": Places("scan/points", "scan_ground_truth", normals="scan_normals/normals", eye="scan/camera"),
    "clouds": Places(
        "cloud/points", "cloud_ground_truth", normals="cloud_normals/normals", eye="cloud/viewpoint"
    ),
}


class Shape:
    """A mesh, scan or point cloud of an export: /ITEM or /ITEM_VIEW. `painted` and `script` are the report's
    drawings of it; `left_out` are people whose fixations it does not show."""

    def __init__(self, name: str, group: Any) -> None:
        self.name = name
        self.group = group
        self.dataset = text(group.attrs["dataset"])
        self.item = text(group.attrs["item"])
        self.category = text(group.attrs.get("class", ""))
        self.view = str(int(group.attrs["view"])) if self.dataset == "scans" else ""
        self.places = PLACES[self.dataset]
        self.painted: dict[tuple[str, str], str] = {}  # (model, when) -> path of a picture within the report
        self.script = ""  # for the viewer, relative to the pages of shapes; empty: none
        self.left_out: Collection[str] = ()

    def __str__(self) -> str:
        return (
            f"scan {self.view} of mesh {self.item}"
            if self.view
            else f"{KIND_NAMES[self.dataset]} {self.item}"
        )

    def has(self, what: str, when: str = "before") -> bool:
        """True if a map is painted: ("LS", "after") or ("ground truth", "before")."""
        return (what, when) in self.painted

    def _array(self, path: str) -> Any:
        try:
            return self.group[path][:] if path else None
        except BROKEN:
            return None

    @property
    def points(self) -> Floats | None:
        """n x 3 float64, or None."""
        points: Floats | None = self._array(self.places.points)
        return points

    @property
    def faces(self) -> Faces | None:
        """f x 3 int32; None for scans and point clouds."""
        faces: Faces | None = self._array(self.places.faces)
        return faces

    @property
    def ground_truth(self) -> Floats | None:
        """n float64 in [0, 1], or None if unknown. Points that nobody saw are shown like the lowest."""
        values = self._array(f"{self.places.ground_truth}/saliency")
        if values is None or len(values) == 0 or numpy.isnan(values).all():
            return None
        return unit_range(numpy.where(numpy.isnan(values), numpy.nanmin(values), values))

    @property
    def picks(self) -> Faces:
        """Indices of the distinct points that participants picked; empty if none."""
        found = self._array(f"{self.places.ground_truth}/picks")
        picks: Faces = numpy.unique(found) if found is not None else numpy.zeros(0, dtype=numpy.int32)
        return picks

    def _hits(self) -> tuple[Faces, Floats]:
        """Corners of the faces fixated by people who are not left out, k x 3, and their weights; k is 0 if
        gaze was not recorded, or missed the shape."""
        arrays = [self._array(f"gaze_hits/{name}") for name in ("face", "weights", "person", "people")]
        faces = self.faces
        if faces is None or any(values is None for values in arrays):
            return numpy.zeros((0, 3), numpy.int32), numpy.zeros((0, 3))
        face, weights, person, people = arrays
        if weights.shape != (len(face), 3) or person.shape != face.shape:
            return numpy.zeros((0, 3), numpy.int32), numpy.zeros((0, 3))
        names = people.tobytes().decode("utf-8", "replace").split("\n")
        left_out = [k for k, name in enumerate(names) if name in self.left_out]
        shown = (face >= 0) & (face < len(faces)) & ~numpy.isin(person, left_out)
        return faces[face[shown]], weights[shown]

    @property
    def fixations(self) -> Floats:
        """k x 3: fixated positions."""
        corners, weights = self._hits()
        points = self.points
        if points is None or ((corners < 0) | (corners >= len(points))).any():
            return numpy.zeros((0, 3))
        places: Floats = (points[corners] * weights[:, :, None]).sum(axis=1)
        return places

    @property
    def marked(self) -> Faces:
        """Indices of the distinct points that participants picked, or else of those nearest to the
        fixations."""
        corners, weights = self._hits()
        nearest: Faces = (
            corners[numpy.arange(len(corners)), weights.argmax(axis=1)] if len(corners) else corners[:, 0]
        )
        picks = self.picks
        return picks if len(picks) else numpy.unique(nearest)

    def _length(self, path: str) -> int:
        """Length of an array, without reading it; 0 if missing."""
        try:
            return len(self.group[path])
        except BROKEN:
            return 0

    @property
    def has_picks(self) -> bool:
        return self._length(f"{self.places.ground_truth}/picks") > 0

    @property
    def has_gaze(self) -> bool:
        return self._length("gaze_hits/face") > 0

    @property
    def has_points(self) -> bool:
        return self._length(self.places.points) > 0

    @cached_property
    def stages(self) -> dict[tuple[str, str], str]:
        """(model, when) -> stage that made the map, in the order of their names."""
        parts = ((stage, *stage.partition(".")[::2]) for stage in sorted(self.group))
        return {(model, KINDS[kind]): stage for stage, kind, model in parts if kind in KINDS and model}

    def maps(self) -> Maps:
        """(model, when) -> n float64 in [0, 1]."""
        found = {key: self._array(f"{stage}/saliency") for key, stage in self.stages.items()}
        return {
            key: unit_range(self._on_points(values))
            for key, values in found.items()
            if values is not None and len(values)
        }

    def _on_points(self, values: Floats) -> Floats:
        """Converts scored values of faces to area-weighted means at the vertices."""
        points, faces = self.points, self.faces
        if points is None or faces is None or len(values) == len(points) or len(values) != len(faces):
            return values
        from salbench import _core

        try:
            return _core.vertex_values_of_faces(points, faces, values)
        except ValueError:  # faces refer to missing points
            return values

    def seen_from(self) -> Floats | None:
        """Viewpoint of the points of a scan or point cloud, or None."""
        eye = self._array(self.places.eye)
        return eye.reshape(-1) if eye is not None and eye.size == 3 else None

    def shade(self, eye: Floats | None) -> Floats | None:
        """Brightness of separate points, n in [0, 1], from their viewpoint, otherwise from `eye`; None if
        viewpoint or normals are missing or incomplete."""
        points, normals, camera = self.points, self._array(self.places.normals), self.seen_from()
        camera = eye if camera is None else camera
        # only for points without faces
        if points is None or normals is None or camera is None or numpy.isnan(normals).any():
            return None
        towards = camera - points
        lengths = numpy.linalg.norm(towards, axis=1, keepdims=True)
        towards /= numpy.where(lengths > 0, lengths, 1)
        shade: Floats = numpy.clip(numpy.abs((normals * towards).sum(axis=1)), 0, 1)
        return shade

    def eye(self, picture: Picture | None) -> tuple[Floats | None, str]:
        """Initial viewpoint, or None, and the upward axis: those of the picture if there is one, else those
        of the scan."""
        return picture.camera() if picture is not None else (self.seen_from(), "y")

    def picture(self) -> Picture | None:
        """The picture, or None if the export has no usable one."""
        arrays = {of.name: self._array(f"picture/{of.name}") for of in fields(Picture)}
        if any(values is None for values in arrays.values()):
            return None
        if arrays["weights"].dtype.kind == "u":  # fractions of the type's range
            arrays["weights"] = arrays["weights"] * numpy.float32(
                1 / numpy.iinfo(arrays["weights"].dtype).max
            )
        return Picture(**arrays)


def _opened(path: Path) -> h5py.File:
    try:
        return h5py.File(path, "r")
    except OSError as error:
        if "lock" not in str(error):
            raise
        # file systems of clusters may have none; not at once, since a process opens a file in one way only
        return h5py.File(path, "r", locking=False)


class Shapes:
    """All shapes of some exports, by name; the first export with a name counts."""

    def __init__(self, paths: Sequence[str | Path]) -> None:
        self.files: list[Any] = []
        self.shapes: dict[str, Shape] = {}
        for path in paths:
            self._open(Path(path))

    def _open(self, path: Path) -> None:
        if path.exists():
            require_file(path, most=1 << 62)  # the library would wait for a pipe
        try:
            file = _opened(path)
            layout = text(file.attrs.get("layout", ""))
        except OSError as error:
            raise InputError(
                f"{path}: cannot be read as HDF5 ({' '.join(str(error).split())}); name a file of salbench "
                "export with --export"
            ) from None
        if not layout.startswith("salbench export"):
            raise InputError(f"{path}: not a file of salbench export; name one with --export")
        self.files.append(file)
        for name in file:
            try:
                group = file[name]
                if isinstance(group, h5py.Group) and text(group.attrs.get("dataset", "")) in PLACES:
                    shape = Shape(name, group)
                    self.shapes.setdefault(shape_name(shape.item, shape.view), shape)
            except BROKEN:
                continue  # a link to a missing artefact: the page of the shape reports it

    def itself(self, item: str) -> Shape | None:
        """Returns the mesh or point cloud."""
        return self.shapes.get(shape_name(item))

    def scans(self, item: str) -> list[Shape]:
        """Returns the available scans of a mesh, in the order of their views."""
        found = [shape for shape in self.shapes.values() if shape.view and shape.item == item]
        return sorted(found, key=lambda shape: natural(shape.view))

    @property
    def models(self) -> list[str]:
        """Models that a shape has a map of."""
        return sorted({model for shape in self.shapes.values() for model, _ in shape.stages})

    @property
    def items(self) -> list[str]:
        """Meshes that are available themselves or as a scan, and point clouds."""
        return sorted({shape.item for shape in self.shapes.values()}, key=natural)
