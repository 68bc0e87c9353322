# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of the benchmark: their arguments (settings), the call (run), a dry run (plan) and output (results,
cache); trained models (folds, learning, cross_validation). hooks has the callbacks of the engine."""
