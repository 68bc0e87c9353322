# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a run, drawn from what salbench documents: tables, run.yaml, exports. See write.py."""
