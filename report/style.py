# SPDX-License-Identifier: GPL-3.0-or-later
"""How figures look, and how they are written: one SVG for the page and one PDF for print, the same bytes every time."""

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
    """No window system, and the settings above. Matplotlib is loaded here, where there is something to draw."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update(_SETTINGS)


def new_figure(width, height, layout="constrained"):
    """An empty figure; inches. What is drawn on it is recorded, and drawn when it is saved (drawing.py)."""
    def make():
        from matplotlib.figure import Figure

        apply()
        return Figure(figsize=(width, height), layout=layout)
    return Drawing(make, (width, height), layout)


def save(figure, svg, pdf):
    """Writes both files, without dates. Laid out once; savefig would draw each file twice."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    dpi = figure.dpi
    FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": "salbench"})
    figure.dpi = dpi
    FigureCanvasPdf(figure).print_pdf(pdf, metadata={"CreationDate": None, "Creator": "salbench", "Producer": None})
