# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a run: reads what salbench documents (tables, run.yaml, exports) and draws it. See
write.py."""
