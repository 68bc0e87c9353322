# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of the benchmark: what is run (settings), the call (run), what it would do (plan), what it left
(results, cache); models that learn (folds, learning, cross_validation). hooks is what the engine asks of
Python meanwhile."""
