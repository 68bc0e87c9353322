# SPDX-License-Identifier: GPL-3.0-or-later
"""Submissions to a leaderboard, and the site that ranks them: docs/leaderboard.md.

card.py is what authors say of a model, origin.py what a run knows of how its maps came about. archive.py and
texts.py read what strangers wrote, expected.py and submission.py check it, board.py scores it and draws the
conclusions, site.py and model_page.py show it all. commands.py has `submit`, `leaderboard` and the runs that
all start, reproduce.py the third subcommand.
"""
