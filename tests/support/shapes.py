# SPDX-License-Identifier: GPL-3.0-or-later
"""Small shapes, and their text in files."""

import numpy as np

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])  # of a tetrahedron
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def sphere(rings=12, sides=14):
    """Points and faces of a closed surface of radius 1."""
    up, around = np.meshgrid(np.pi * (np.arange(1, rings) / rings - 0.5), 2 * np.pi * np.arange(sides) / sides, indexing="ij")
    points = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], -1).reshape(-1, 3)
    points = np.vstack([points, [[0, 0, -1], [0, 0, 1]]])
    faces = []
    for i in range(sides):
        j, last = (i + 1) % sides, (rings - 2) * sides
        faces += [(j, i, len(points) - 2), (last + i, last + j, len(points) - 1)]
        faces += [corner for k in range(0, last, sides) for corner in ((k + i, k + j, k + sides + j), (k + i, k + sides + j, k + sides + i))]
    return points, np.array(faces)


def rows(*columns):
    """Numbers side by side, to the bit: a cloud of points, its normals, values of each."""
    return "".join(" ".join(map(repr, row)) + "\n" for row in np.column_stack([np.asarray(column, float) for column in columns]).tolist())


def lines(values):
    return "".join(f"{value!r}\n" for value in np.asarray(values).tolist())


def off(points=POINTS, faces=FACES):
    return f"OFF\n{len(points)} {len(faces)} 0\n" + rows(points) + "".join(f"3 {a} {b} {c}\n" for a, b, c in np.asarray(faces).tolist())


def obj(points=POINTS, faces=FACES):
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()) + "".join(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())
