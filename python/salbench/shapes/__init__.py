# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes in memory: Shape, and functions on arrays without a data set (stages, gaze, scoring)."""
