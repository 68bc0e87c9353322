# SPDX-License-Identifier: GPL-3.0-or-later
"""Submissions to a leaderboard, and the site that ranks them: docs/leaderboard.md.

card.py reads the authors' statements on a model, origin.py records the provenance of its maps. archive.py and
texts.py read untrusted files, expected.py and submission.py check them, board.py scores them and draws the
conclusions, site.py and model_page.py write the pages. commands.py has `submit`, `leaderboard` and the runs
that all start, reproduce.py the third subcommand.
"""
