# SPDX-License-Identifier: GPL-3.0-or-later
"""Building blocks of HTML pages: elements and their templates, styles, scripts, and the viewer of a shape.
Shared by the report, the leaderboard and `Shape.show`; knows nothing of results."""
