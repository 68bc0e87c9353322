#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""ps_model.py SHAPE OUT: PS as a command of its own, beside which the built-in one is laid."""
import sys

import h5py
import numpy as np

FLAT_BINS = [5, 16, 27]  # theta, alpha and phi of a flat patch

with h5py.File(sys.argv[1]) as shape:
    fpfh = shape["fpfh"][:].astype(float)
centred = fpfh - fpfh.mean(axis=0)
axis = np.linalg.eigh(centred.T @ centred / len(centred))[1][:, -1]
if axis[FLAT_BINS].sum() > 0:
    axis = -axis
np.savetxt(sys.argv[2], centred @ axis, fmt="%.17g")
