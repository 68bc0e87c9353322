# SPDX-License-Identifier: GPL-3.0-or-later
"""Version of the package, equal to the program's (CMakeLists.txt)."""

__version__ = "2.0.0"
