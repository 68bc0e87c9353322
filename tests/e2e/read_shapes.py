# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads exported shapes and compares them with an HDF5 export.

read_shapes.py EXPORT.h5 FOLDER: FOLDER holds ITEM.ply of every item of the export. Prints "ok: N items" or says what is wrong.
"""

import pathlib
import sys

import h5py
import numpy

PLY_TYPES = {"double": "<f8", "float": "<f4"}


def expect(same, path, what):
    if not same:
        sys.exit(f"{path}: {what} differs from the export")


def expected(item):
    """Points, normals, faces (None where there are none) and the fields of an item of the export."""
    mesh = "mesh" in item
    points = item["mesh/vertices"][:] if mesh else item["scan/points"][:]
    normals = item["normals/normals" if mesh else "scan_normals/normals"][:]
    faces = item["mesh/faces" if mesh else "surface/faces"][:]
    truth = item["ground_truth" if mesh else "scan_ground_truth"]
    fields = {"ground_truth": truth["saliency"][:],
              "picks": numpy.bincount(truth["picks"][:], minlength=len(points)).astype(float)}
    for stage in item:
        if stage.split(".")[0] in ("map", "matched"):
            fields[stage.replace(".", "_")] = item[stage]["saliency"][:]
    return points, normals, faces, fields


def read_ply(path):
    """Vertices with their properties, and faces."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    counts, columns = {}, []
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        if words[0] == "property" and words[1] in PLY_TYPES:
            columns.append((words[2], PLY_TYPES[words[1]]))
    vertices = numpy.frombuffer(body, dtype=columns, count=counts["vertex"])
    faces = numpy.frombuffer(body, dtype=[("n", "u1"), ("corners", "<i4", 3)], count=counts.get("face", 0), offset=vertices.nbytes)
    expect((faces["n"] == 3).all(), path, "the size of faces")
    return vertices, faces["corners"]


def check_ply(path, points, normals, faces, fields):
    single = numpy.float32
    vertices, corners = read_ply(path)
    expect(numpy.array_equal(corners, faces), path, "faces")
    for axis, name in enumerate("xyz"):
        expect(numpy.array_equal(vertices[name], points[:, axis]), path, name)
        expect(numpy.array_equal(vertices[f"n{name}"], normals[:, axis].astype(single)), path, f"n{name}")
    expect(set(vertices.dtype.names) == {"x", "y", "z", "nx", "ny", "nz", *fields}, path, "the set of properties")
    for name, values in fields.items():
        expect(numpy.array_equal(vertices[name], values.astype(single)), path, name)


def main():
    folder = pathlib.Path(sys.argv[2])
    with h5py.File(sys.argv[1], "r") as file:
        items = {name: item for name, item in file.items() if "dataset" in item.attrs}
        for name, item in items.items():
            points, normals, faces, fields = expected(item)
            check_ply(folder / f"{name}.ply", points, normals, faces, fields)
    print(f"ok: {len(items)} items")


main()
