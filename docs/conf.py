# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx's configuration, read in the copy of docs/ that scripts/docs builds."""

import salbench

project = "salbench"
author = "The salbench maintainers"
version = release = salbench.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_heading_anchors = 3  # [text](page.md#heading) is checked
smartquotes = False  # texts of the program stay as printed
html_theme = "furo"
html_title = f"salbench {version}"
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
default_role = "code"  # `names` in docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # signatures have them; docstrings describe the arguments
