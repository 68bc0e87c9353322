# SPDX-License-Identifier: GPL-3.0-or-later
"""The package's layer above the system: files, texts and tables, processes, the console; and exceptions,
grouped by who has to act."""
