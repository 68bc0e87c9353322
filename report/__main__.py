# SPDX-License-Identifier: GPL-3.0-or-later
import sys

if sys.argv[1:2] == ["leaderboard"]:
    from report.leaderboard import main

    sys.exit(main(sys.argv[2:]))

from report.cli import main

sys.exit(main())
