# SPDX-License-Identifier: GPL-3.0-or-later
"""How figures look, and how they are written: one SVG for the page and one PDF for print, the same bytes every time."""

import matplotlib
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from report.drawing import Drawing

INK = "#1a1a1a"
GRID = "#dddddd"
MAP = "viridis"  # every saliency and score map: even in lightness, safe for colour-blind readers

_SETTINGS = {
    "svg.hashsalt": "salbench",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",  # comes with Matplotlib, so that labels do not depend on the machine
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.labelsize": 11,
    "axes.edgecolor": "#555555",
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "image.cmap": MAP,
    "savefig.facecolor": "white",
}


def apply():
    """No window system, and the settings above."""
    matplotlib.use("Agg")
    matplotlib.rcParams.update(_SETTINGS)


def new_figure(width, height, layout="constrained"):
    """An empty figure; inches. What is drawn on it is recorded, and drawn when it is saved (drawing.py)."""
    return Drawing(lambda: Figure(figsize=(width, height), layout=layout), (width, height), layout)


def scale():
    """What a colour bar of a map in [0, 1] is drawn from."""
    return ScalarMappable(Normalize(0, 1), MAP)


def save(figure, svg, pdf):
    """Writes both files, without dates. Laid out once; savefig would draw each file twice."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    dpi = figure.dpi
    FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": "salbench"})
    figure.dpi = dpi
    FigureCanvasPdf(figure).print_pdf(pdf, metadata={"CreationDate": None, "Creator": "salbench", "Producer": None})
