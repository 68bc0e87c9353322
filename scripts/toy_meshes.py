#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by tests and by other scripts.
"""Writes toy meshes, tori with bumps of different kinds: scripts/toy_meshes.py FOLDER COUNT ROUND ACROSS

Each has ROUND x ACROSS vertices.
"""
import math
import os
import sys


def bumpy_torus(around, across, bumps):
    vertices, faces = [], []
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            tube = 0.35 + 0.06 * math.cos(bumps * u) * math.sin(3 * v)
            radius = 1 + tube * math.cos(v)
            vertices.append((radius * math.cos(u), radius * math.sin(u), tube * math.sin(v)))
            here, next_i = i * across, (i + 1) % around * across
            next_j = (j + 1) % across
            faces.append((here + j, next_i + j, here + next_j))
            faces.append((here + next_j, next_i + j, next_i + next_j))
    return vertices, faces


def write_mesh(path, vertices, faces):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("{:.6f} {:.6f} {:.6f}\n".format(*v) for v in vertices)
        file.writelines("3 {} {} {}\n".format(*f) for f in faces)


def main():
    folder, (count, around, across) = sys.argv[1], map(int, sys.argv[2:])
    os.makedirs(folder)
    for k in range(1, count + 1):
        write_mesh(f"{folder}/{k}.off", *bumpy_torus(around, across, k + 1))


if __name__ == "__main__":
    main()
