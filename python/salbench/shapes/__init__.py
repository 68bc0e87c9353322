# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes in memory: Shape, and what is computed of arrays without a data set (stages, gaze, scoring)."""
