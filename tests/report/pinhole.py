# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a shape as the stage `picture` describes it, by brute force: small, slow, and for tests alone."""

import numpy


def camera(points, towards, size):
    """Camera 4 radii from the middle of n x 3 points in direction `towards`: its position and view_projection (4 x 4)."""
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = numpy.linalg.norm(points - middle, axis=1).max()
    back = numpy.asarray(towards, dtype=float) / numpy.linalg.norm(towards)
    eye = middle + 4 * radius * back
    right = numpy.cross([0, 1, 0] if abs(back[1]) < 0.9 else [0, 0, 1], back)
    right /= numpy.linalg.norm(right)
    view = numpy.eye(4)
    view[:3, :3] = [right, numpy.cross(back, right), back]
    view[:3, 3] = -view[:3, :3] @ eye
    focus = 3.6
    projection = numpy.diag([focus, focus, -1.0, 0.0])
    projection[2, 3], projection[3, 2] = -2 * radius, -1.0
    return eye, projection @ view


def pixels(points, view_projection, size):
    clip = numpy.column_stack([points, numpy.ones(len(points))]) @ view_projection.T
    flat = clip[:, :2] / clip[:, 3:]
    return (flat[:, 0] + 1) / 2 * size, (1 - flat[:, 1]) / 2 * size, clip[:, 3]


def empty(size):
    return (numpy.full((size, size), -1, numpy.int32), numpy.zeros((size, size, 3), numpy.float32),
            numpy.full((size, size), 255, numpy.uint8), numpy.full((size, size), numpy.inf, numpy.float32))


def picture_of_mesh(points, faces, towards=(1.0, 0.6, 1.2), size=400):
    """The data sets of /ITEM/picture."""
    eye, view_projection = camera(points, towards, size)
    x, y, distance = pixels(points, view_projection, size)
    primitive, weights, shade, depth = empty(size)
    for index, (a, b, c) in enumerate(faces):
        area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
        left, right = int(max(min(x[a], x[b], x[c]), 0)), int(min(max(x[a], x[b], x[c]) + 1, size))
        top, bottom = int(max(min(y[a], y[b], y[c]), 0)), int(min(max(y[a], y[b], y[c]) + 1, size))
        if abs(area) < 1e-9 or left >= right or top >= bottom:
            continue
        px, py = numpy.meshgrid(numpy.arange(left, right) + 0.5, numpy.arange(top, bottom) + 0.5)
        wb = ((px - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (py - y[a])) / area
        wc = ((x[b] - x[a]) * (py - y[a]) - (px - x[a]) * (y[b] - y[a])) / area
        wa = 1 - wb - wc
        far = wa * distance[a] + wb * distance[b] + wc * distance[c]
        part = (slice(top, bottom), slice(left, right))
        seen = (wa >= 0) & (wb >= 0) & (wc >= 0) & (far < depth[part])
        normal = numpy.cross(points[b] - points[a], points[c] - points[a])
        light = abs(normal @ (eye - points[a])) / max(numpy.linalg.norm(normal) * numpy.linalg.norm(eye - points[a]), 1e-30)
        primitive[part][seen], depth[part][seen] = index, far[seen]
        weights[part][seen] = numpy.stack([wa, wb, wc], axis=-1)[seen]
        shade[part][seen] = round(255 * (0.35 + 0.65 * light))
    return {"primitive": primitive, "weights": weights, "shade": shade, "depth": depth, "view_projection": view_projection,
            "coverage": numpy.where(primitive >= 0, 255, 0).astype(numpy.uint8)}


def picture_of_points(points, towards, size=400, half=3):
    """Points as squares of 2 half + 1 pixels."""
    view_projection = camera(points, towards, size)[1]
    x, y, distance = pixels(points, view_projection, size)
    primitive, weights, shade, depth = empty(size)
    for index in numpy.argsort(-distance):
        part = (slice(max(int(y[index]) - half, 0), int(y[index]) + half + 1),
                slice(max(int(x[index]) - half, 0), int(x[index]) + half + 1))
        primitive[part], depth[part], shade[part] = index, distance[index], 235
    weights[primitive >= 0] = (1, 0, 0)
    return {"primitive": primitive, "weights": weights, "shade": shade, "depth": depth, "view_projection": view_projection,
            "coverage": numpy.where(primitive >= 0, 255, 0).astype(numpy.uint8)}


def add_pictures(file, size=400):
    """Writes /ITEM/picture for every shape of an open export (h5py.File in mode r+)."""
    for name, group in file.items():
        if "dataset" not in group.attrs:
            continue
        if "mesh" in group:
            picture = picture_of_mesh(group["mesh/vertices"][:], group["mesh/faces"][:], size=size)
        elif "scan" in group:
            points = group["scan/points"][:]
            picture = picture_of_points(points, group["scan/camera"][:] - points.mean(axis=0), size=size)
        elif "cloud" in group:
            picture = picture_of_points(group["cloud/points"][:], (1.0, 0.6, 1.2), size=size)
        else:
            continue
        for key, values in picture.items():
            group.create_dataset(f"picture/{key}", data=values, compression="gzip")
