#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A minimal model: the height of a point. It is started once, and processes one shape after another.

model.py LIST    one line per shape: an HDF5 file to read and the file to write, separated by a tab
"""
import sys

import h5py
import numpy as np

# A network and its weights would be loaded here, once.

with open(sys.argv[1], encoding="utf-8") as shapes:
    for line in shapes:  # the next line arrives after the answer to this one
        shape, out = line.rstrip("\n").split("\t")
        with h5py.File(shape) as file:
            np.save(out, file["points"][:, 2])
        print(out, flush=True)  # the answer
