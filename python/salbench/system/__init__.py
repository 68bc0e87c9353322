# SPDX-License-Identifier: GPL-3.0-or-later
"""What the package asks of the system: files and their texts and tables, processes, the console; and its
exceptions, by who has to act."""
