# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions, by who has to act."""


class InputError(ValueError):
    """A file, a table or a description that cannot be used: one line that says what, where, and what to do."""


class StorageError(OSError):
    """A folder or file that cannot be written."""
