# SPDX-License-Identifier: GPL-3.0-or-later
"""Local maxima of a map on a surface, and errors of interest points, from their definitions: all distances between all
points, by SciPy. Used by metrics_reference.py and the twins of the protocols."""
import math

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import distance


def edges_of(faces):
    """(m, 2), each edge once, without those of a corner with itself."""
    faces = np.asarray(faces, int).reshape(-1, 3)
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)


def extent(points):
    """R, the largest distance from the centroid, and the largest distance of two points."""
    return np.linalg.norm(points - points.mean(axis=0), axis=1).max(), distance.pdist(points).max()


def along_edges(points, edges):
    """(n, n) lengths of the shortest paths."""
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = sparse.coo_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(len(points), len(points)))
    return csgraph.dijkstra(graph.tocsr(), directed=False)


def local_maxima(map_, edges, distances, radius, height):
    """One point for each plateau that is higher than all around it, and rises above something."""
    level = edges[map_[edges[:, 0]] == map_[edges[:, 1]]]
    n = len(map_)
    labels = csgraph.connected_components(sparse.coo_matrix((np.ones(len(level)), (level[:, 0], level[:, 1])), shape=(n, n)), directed=False)[1]
    found = []
    for label in range(labels.max() + 1):
        inside = labels == label
        around = np.concatenate([edges[inside[edges[:, 0]], 1], edges[inside[edges[:, 1]], 0]])
        value = map_[inside][0]
        if (map_[around] < value).any() and not (map_[around] > value).any():
            found.append(np.flatnonzero(inside)[0])
    if radius > 0:
        numbers = np.arange(n)
        found = [i for i in found
                 if not ((distances[i] <= radius) & ((map_ > map_[i]) | ((map_ == map_[i]) & (numbers < i)))).any()]
    found = np.array(sorted(found), int)
    return found[map_[found] >= height * map_[found].mean() * (1 - 1e-9)] if len(found) else found


def errors(detected, marks, distances, reach):
    """Dutagaci, Cheung, Godil 2012, with a detected point that is as close to two marked ones counted for the first."""
    marked, times = np.unique(marks, return_counts=True)
    if not len(marked):
        return dict.fromkeys(("fne", "fpe", "wme"), math.nan)
    near = distances[np.ix_(marked, detected)]  # [marked, detected]
    found = np.zeros(len(marked), bool)
    for column in near.T:
        if column.min() <= reach:
            found[column.argmin()] = True
    n = len(detected)
    return {
        "fne": 1 - found.sum() / len(marked),
        "fpe": 1 - found.sum() / n if n else 1.0,
        "wme": 1 - times[found].sum() / times.sum(),
    }


def interest_points(case):
    """Interest points of a case whose map is min-max-normalised."""
    points, edges = np.asarray(case["points"]), case["edges"]
    if not len(edges):
        return dict.fromkeys(("fne", "fpe", "wme"), math.nan)
    distances = along_edges(points, edges)
    detected = local_maxima(case["map"], edges, distances, case["peak_radius"] * case["radius"], case["peak_height"])
    return errors(detected, case["picks"], distances, case["tolerance"] * case["diameter"])
