# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as nine kinds of programs write them, with the same doubles and the same triangles in each.

Neighbouring triangles that are coplanar are first put one behind the other, as the two of a quad, which one of the dialects writes."""

from pathlib import Path

import numpy as np

FLAT = 1e-9  # of a pair of triangles: volume of their tetrahedron by the cube of its longest edge


def read_off(path):
    """Points and triangles of a plain OFF file."""
    words = Path(path).read_text().split()
    n, f = int(words[1]), int(words[2])
    faces = np.array(words[4 + 3 * n:4 + 3 * n + 4 * f], int).reshape(f, 4)
    assert words[0] == "OFF" and (faces[:, 0] == 3).all(), path
    return np.array(words[4:4 + 3 * n], float).reshape(n, 3), faces[:, 1:]


def in_pairs(points, faces):
    """The triangles as polygons: (a, b, c, d) for a, b, c and a, c, d that are coplanar, if the quad is convex; each in one pair at most."""
    n, f = len(points), len(faces)
    a, b, c = (np.roll(faces, -k, axis=1).ravel() for k in range(3))  # of each triangle three times, from each of its corners
    keys = a * n + b
    order = np.argsort(keys)
    at = order[np.searchsorted(keys[order], a * n + c).clip(max=3 * f - 1)]  # the neighbour beyond c a, where there is one
    others = at // 3
    d = faces[others].sum(axis=1) - a - c
    good = np.flatnonzero((keys[at] == a * n + c) & are_flat_and_convex(points[np.stack([a, b, c, d % n], axis=1)]))
    polygons, used = list(map(tuple, faces.tolist())), set()
    for number, other, corners in zip((good // 3).tolist(), others[good].tolist(), np.stack([a, b, c, d], axis=1)[good].tolist()):
        if number not in used and other not in used:
            used |= {number, other}
            polygons[number], polygons[other] = tuple(corners), None
    return [polygon for polygon in polygons if polygon]


def are_flat_and_convex(corners):
    """True for planar and convex quads; corners: (k, 4, 3)."""
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.abs(edges).max(axis=(1, 2))
    turns = np.cross(edges, np.roll(edges, -1, axis=1))
    normals = turns.sum(axis=1)
    volumes = np.abs((edges[:, 0] * np.cross(edges[:, 1], edges[:, 2])).sum(axis=1))
    left = (turns * normals[:, None]).sum(axis=2).min(axis=1)
    return (volumes <= FLAT * longest**3) & (left > 1e-6 * longest**2 * np.linalg.norm(normals, axis=1))


class Form:
    """Shape in the form that the dialects write."""

    def __init__(self, points, polygons):
        self.points, self.polygons = points, polygons
        self.triangles = [(polygon[0], *polygon[k:k + 2]) for polygon in polygons for k in range(1, len(polygon) - 1)]
        self.places = [" ".join(map(repr, place)) for place in points.tolist()]
        self.counts = f"{len(points)} {len(self.triangles)}"

    def corners(self, base=0):
        return [f"{a + base} {b + base} {c + base}" for a, b, c in self.triangles]


def off(form):
    return "\n".join(["OFF", f"{form.counts} 0", *form.places, *(f"3 {corners}" for corners in form.corners())]) + "\n"


def off_noisy(form):
    """Comments, blank lines, tabs, records over two lines, colours of faces as whole numbers and as shares."""
    places = [place.replace(" ", "\n" if number % 7 == 0 else "\t", 1) + ("  # a vertex" if number % 5 == 0 else "") for number, place in enumerate(form.places)]
    faces = [f" 3  {corners}  {'255 0 0' if number % 2 else '0.5 0.25 1.0 1.0'}" for number, corners in enumerate(form.corners())]
    return "\n".join(["# exported", "", "OFF # by hand", "", "# counts", form.counts, "0", *places, "", "# faces", *faces, "", "# end"])


def off_crlf(form):
    return off(form).replace("\n", " \r\n")


def off_quads(form):
    faces = [f"{len(polygon)} {' '.join(map(str, polygon))}" for polygon in form.polygons]
    return "\n".join(["OFF", f"{len(form.points)} {len(faces)} 0", *form.places, *faces]) + "\n"


def ply_ascii(form):
    """Comments, normals that are not those of the surface, colours, further properties of faces, and an element behind them."""
    head = ["ply", "format ascii 1.0", "comment made by hand", "obj_info of nothing", f"element vertex {len(form.points)}",
            *(f"property double {axis}" for axis in "xyz"), *(f"property float n{axis}" for axis in "xyz"),
            *(f"property uchar {colour}" for colour in ("red", "green", "blue")), f"element face {len(form.triangles)}",
            "property list uchar int vertex_indices", "property list uchar float texcoord", "property int flags",
            "element edge 1", "property int vertex1", "property int vertex2", "end_header"]
    return "\n".join([*head, *(f"{place} 0 0 1 255 127 0" for place in form.places), *(f"3 {corners} 2 0.5 0.25 -1" for corners in form.corners()), "0 1"]) + "\n"


def ply_binary(order, form):
    """As ply_ascii; a property before the coordinates, and the list of corners behind another one."""
    vertices = np.zeros(len(form.points), [("confidence", order + "f4"), ("place", order + "f8", 3), ("rgba", "u1", 4)])
    vertices["confidence"], vertices["place"], vertices["rgba"] = 0.5, form.points, 200
    faces = np.zeros(len(form.triangles), [("flags", "u1"), ("n", order + "u2"), ("corners", order + "u4", 3), ("m", "u1"), ("uv", order + "f4", 6)])
    faces["n"], faces["corners"], faces["m"] = 3, form.triangles, 6
    head = ["ply", f"format binary_{'little' if order == '<' else 'big'}_endian 1.0", "comment made by hand", f"element vertex {len(vertices)}",
            "property float confidence", *(f"property double {axis}" for axis in "xyz"),
            *(f"property uchar {colour}" for colour in ("red", "green", "blue", "alpha")), f"element face {len(faces)}", "property uchar flags",
            "property list ushort uint vertex_index", "property list uchar float texcoord", "end_header"]
    return "\n".join([*head, ""]).encode() + vertices.tobytes() + faces.tobytes()


def ply_little(form):
    return ply_binary("<", form)


def ply_big(form):
    return ply_binary(">", form)


def obj(form):
    return "\n".join([*(f"v {place}" for place in form.places), *(f"f {corners}" for corners in form.corners(1))]) + "\n"


def obj_interleaved(form):
    """A face as soon as its vertices are there, counted back from the last one; groups, materials, textures, a line over two."""
    lines, written = ["# exported", "mtllib a\\b.mtl", "o shape", "vt 0 0", "vn 0 0 1"], 0
    for number, triangle in enumerate(form.triangles):
        needed = max(triangle) + 1
        lines += [f"v {place} 0.5 0.5 0.5" for place in form.places[written:needed]]
        written = max(written, needed)
        if number % 50 == 0:
            lines += [f"g part{number}", "usemtl mats\\wood\\", "s off"]
        a, b, c = (index - written for index in triangle)
        lines += [f"f {a}/1/1 {b}//1 \\", f"  {c}/1"] if number % 9 == 0 else [f"f {a} {b} {c} # a face"]
    return "\n".join([*lines, *(f"v {place}" for place in form.places[written:])])


DIALECTS = {write.__name__: (write, write.__name__.partition("_")[0])
            for write in (off, off_noisy, off_crlf, off_quads, ply_ascii, ply_little, ply_big, obj, obj_interleaved)}


def write_all(points, faces, name, to):
    """TO/DIALECT/NAME.ext; returns how many quads there are."""
    form = Form(points, in_pairs(points, faces))
    for dialect, (write, extension) in DIALECTS.items():
        text = write(form)
        (Path(to) / dialect).mkdir(parents=True, exist_ok=True)
        (Path(to) / dialect / f"{name}.{extension}").write_bytes(text if isinstance(text, bytes) else text.encode())
    return len(form.triangles) - len(form.polygons)
