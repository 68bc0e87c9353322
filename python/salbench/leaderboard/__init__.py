# SPDX-License-Identifier: GPL-3.0-or-later
"""Submissions to a leaderboard, and the site that ranks them: docs/leaderboard.md.

archive.py and texts.py read what strangers wrote, submission.py checks it in a worker process, board.py scores it and draws the conclusions,
site.py shows them, commands.py has the two subcommands.
"""
