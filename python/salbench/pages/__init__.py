# SPDX-License-Identifier: GPL-3.0-or-later
"""What pages of HTML are made of: elements and their templates, styles, scripts, and the viewer of a
shape. The report, the leaderboard and `Shape.show` share it; it knows no results."""
