#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as small as one can be: how far up a point lies. It is started once, and answers shape after shape.

model.py LIST    a line per shape: an HDF5 file to read and the file to write, with a tab between them
"""
import sys

import h5py
import numpy as np

# A network and its weights would be loaded here, once.

with open(sys.argv[1], encoding="utf-8") as shapes:
    for line in shapes:  # the next line comes when this one is answered
        shape, out = line.rstrip("\n").split("\t")
        with h5py.File(shape) as file:
            np.save(out, file["points"][:, 2])
        print(out, flush=True)  # the answer
